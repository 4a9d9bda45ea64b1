// sensor.non-linearity as a power law of readings, pictures that were coded for a screen among them; the alternative to
// the quadratic of sensor_non_linearity.cpp. Equation: render/tone_curve.h. The reference is the table's largest value.
#include <cmath>

#include "explain/tables/table_model.h"

namespace gonio::mechanism {
const Mechanism& sensor_non_linearity();
}

namespace gonio::explain::tables {
namespace {

std::size_t place_of(const std::string& name) {
  const std::vector<mechanism::Parameter>& all = mechanism::sensor_non_linearity().parameters;
  std::size_t k = 0;
  while (k < all.size() && all[k].name != name) ++k;
  return k;
}

double act(double f, std::span<const double>, std::span<const double> p) {
  static const std::size_t gamma = place_of("gamma"), reference = place_of("reference");
  return p[gamma] == 1 || !(f > 0) ? f : p[reference] * std::pow(f / p[reference], p[gamma]);
}

void adapt(const Table&, double scale, std::span<TermParameter> p) {
  const std::vector<mechanism::Parameter>& all = mechanism::sensor_non_linearity().parameters;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (all[k].name == "gamma") continue;
    p[k].start = all[k].name == "reference" ? scale : all[k].neutral;
    p[k].use = TermParameter::Use::fixed;
  }
}

}  // namespace

const Term& sensor_non_linearity_gamma() {
  static const Term term{.mechanism = mechanism::sensor_non_linearity,
                         .order = term_order::non_linearity,
                         .models = {"sensor", "light", "volume", "expression"},
                         .applies = [](const Table&) { return true; },
                         .act = act,
                         .adapt = adapt};
  return term;
}

}  // namespace gonio::explain::tables
