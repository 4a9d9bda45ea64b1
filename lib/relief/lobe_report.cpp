// See lobe_report.h.
#include "relief/lobe_report.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "manifest/sections/relief.h"
#include "manifest/sections/surface_fit.h"
#include "manifest/sections/table.h"
#include "report/number_text.h"

namespace gonio::relief {

namespace {

std::vector<double> three(Rgb v) {
  return {v.x, v.y, v.z};
}

}  // namespace

std::string lobe_csv(const std::vector<TracedLobe>& lobes) {
  std::string csv;
  for (const auto& [name, unit] : lobe_columns().columns) csv += (csv.empty() ? "" : ",") + name;
  csv += "\n";
  for (const auto& [wi, lobe] : lobes) {
    const double turn = std::atan2(wi.y, wi.x);
    const std::string light =
        shortest_text(std::acos(std::min(1.0, wi.z))) + "," + shortest_text(turn < 0 ? turn + 2 * pi : turn) + ",";
    for (int t = 0; t < lobe.theta_cells; ++t)
      for (int p = 0; p < lobe.phi_cells; ++p) {
        const Estimate& e = lobe.table[static_cast<std::size_t>(t * lobe.phi_cells + p)];
        csv += light + shortest_text(lobe.theta_rad(t)) + "," + shortest_text(lobe.phi_rad(p));
        for (const Rgb& v : {e.value, e.sigma})
          for (int c = 0; c < 3; ++c) csv += "," + format("%.6g", v[c]);
        csv += "\n";
      }
  }
  return csv;
}

manifest::Table lobe_columns() {
  manifest::Table table;
  table.model = "surface";
  table.columns = {{"theta_i_rad", "rad"}, {"phi_i_rad", "rad"}, {"theta_o_rad", "rad"}, {"phi_o_rad", "rad"}};
  for (const std::string band : {"r", "g", "b"}) table.observed.push_back("f_" + band);
  for (const std::string band : {"r", "g", "b"}) table.sigma.push_back("sigma_" + band);
  for (const auto* names : {&table.observed, &table.sigma})
    for (const std::string& name : *names) table.columns.emplace_back(name, "1/sr");
  return table;
}

manifest::ReliefLobe lobe_entry(double incidence_rad, double azimuth_rad, const LobeTable& lobe) {
  const Energy& energy = lobe.energy;
  manifest::ReliefLobe entry;
  entry.incidence_rad = incidence_rad, entry.azimuth_rad = azimuth_rad;
  entry.reflected = three(energy.reflected.value), entry.lost = three(energy.lost.value);
  entry.cut = three(energy.cut.value);
  entry.by_facets.assign(energy.by_facets.begin(), energy.by_facets.end());
  entry.peak = three(lobe.peak.value), entry.peak_theta_rad = lobe.peak_theta_rad;
  entry.peak_phi_rad = lobe.peak_phi_rad;
  entry.sigma = {{"reflected", three(energy.reflected.sigma)},
                 {"lost", three(energy.lost.sigma)},
                 {"cut", three(energy.cut.sigma)},
                 {"peak", three(lobe.peak.sigma)}};
  return entry;
}

manifest::SurfaceFit surface_entry(const RoughSurface& rough, const std::vector<TracedLobe>& lobes,
                                   const std::string& source) {
  const manifest::Surface& surface = *rough.surface;
  manifest::SurfaceFit entry;
  entry.model = surface.model, entry.source = source;
  for (const char* name : {"alpha", "anisotropy", "azimuth_rad"})
    entry.parameters[name] = surface.parameters.at(name).value;
  entry.sigma = surface.sigma;
  entry.held_out_rms = log1p_rms(surface, lobes);
  const double alpha = entry.parameters["alpha"][0], sigma = entry.sigma["alpha"][0];
  entry.sentence = source + " is " + surface.model + " of alpha " + report::with_sigma(alpha, sigma) +
                   " along its roughest axis, by its normals";
  entry.sentence += entry.held_out_rms
                        ? "; that differs from the traced lobes by " + report::number_text(*entry.held_out_rms, 3) +
                              " (root mean square of ln(1 + 100 f cos cos))."
                        : ": smooth, its lobe is a direction.";
  if (rough.narrower) entry.notes.push_back("across its axis it is smoother than the model can say, alpha / 10");
  return entry;
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
