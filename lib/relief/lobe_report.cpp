// See lobe_report.h.
#include "relief/lobe_report.h"

#include "base/text.h"
#include "report/number_text.h"

namespace gonio::relief {

using manifest::Value;

namespace {

Value three(Rgb v) {
  return std::vector<double>{v.x, v.y, v.z};
}

}  // namespace

std::string lobe_csv(const LobeTable& lobe) {
  std::string csv = "theta_rad,phi_rad,f_r,f_g,f_b,sigma_r,sigma_g,sigma_b\n";
  for (int t = 0; t < lobe.theta_cells; ++t)
    for (int p = 0; p < lobe.phi_cells; ++p) {
      const Estimate& e = lobe.table[static_cast<std::size_t>(t * lobe.phi_cells + p)];
      csv += shortest_text(lobe.theta_rad(t)) + "," + shortest_text(lobe.phi_rad(p));
      for (const Rgb& v : {e.value, e.sigma})
        for (int c = 0; c < 3; ++c) csv += "," + format("%.6g", v[c]);
      csv += "\n";
    }
  return csv;
}

Value lobe_value(double incidence_rad, double azimuth_rad, const LobeTable& lobe) {
  const auto estimate = [](const Estimate& e) {
    return Value::object({{"value", three(e.value)}, {"sigma", three(e.sigma)}});
  };
  const Energy& energy = lobe.energy;
  Value peak = estimate(lobe.peak);
  peak["theta_rad"] = lobe.peak_theta_rad;
  peak["phi_rad"] = lobe.peak_phi_rad;
  return Value::object(
      {{"incidence_rad", incidence_rad},
       {"azimuth_rad", azimuth_rad},
       {"reflected", estimate(energy.reflected)},
       {"lost", estimate(energy.lost)},
       {"cut", estimate(energy.cut)},
       {"share_by_facets_1_2_3_more", std::vector<double>(energy.by_facets.begin(), energy.by_facets.end())},
       {"peak", peak}});
}

std::string energy_sentence(const LobeTable& lobe) {
  const Energy& e = lobe.energy;
  return report::with_sigma(e.reflected.value.y, e.reflected.sigma.y) + " of the light is reflected (green), " +
         report::percent_text(e.by_facets[1] + e.by_facets[2] + e.by_facets[3], 1) +
         " of that by way of more than one facet; the largest cell is " +
         report::with_sigma(lobe.peak.value.y, lobe.peak.sigma.y) + " 1/sr at " +
         report::number_text(lobe.peak_theta_rad / pi * 180, 3) + " degrees.";
}

}  // namespace gonio::relief
