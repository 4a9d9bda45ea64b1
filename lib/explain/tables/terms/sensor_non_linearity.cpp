// sensor.non-linearity as a quadratic of a predicted reading, stated at the table's largest value; or as a power law,
// for pictures that were coded for a screen among others: alone, with a toe, or with a shoulder.
#include "render/mechanisms/sensor_non_linearity.h"

#include <array>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {
namespace {

constexpr std::size_t quadratic = 0, reference = 1, gamma = 2, toe = 3,
                      shoulder = 4;  // places of the mechanism's parameters

template <std::size_t... bent>
void fix_all_but(const Table&, double scale, std::span<TermParameter> p) {
  const std::vector<mechanism::Parameter>& all = mechanism::sensor_non_linearity().parameters;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (((k == bent) || ...)) continue;
    p[k].start = k == reference ? scale : all[k].neutral;
    p[k].use = TermParameter::Use::fixed;
  }
}

double bend(double f, std::span<const double>, std::span<const double> p) {
  return equation::sensor_quadratic(f, p[quadratic], p[reference]);
}
double raise(double f, std::span<const double>, std::span<const double> p) {
  if (!(f > 0)) return f;
  const double v = p[gamma] == 1 ? f : equation::sensor_power_law(f, p[gamma], p[reference], p[toe]);
  return p[shoulder] == 0 ? v : equation::sensor_shoulder(v, p[shoulder], p[reference]);
}

Term response(double (*act)(double, std::span<const double>, std::span<const double>),
              void (*adapt)(const Table&, double, std::span<TermParameter>)) {
  return {.mechanism = mechanism::sensor_non_linearity,
          .order = term_order::non_linearity,
          .models = {"sensor", "light", "volume", "expression", "probe-radiance", "chart"},
          .applies = [](const Table&) { return true; },
          .act = act,
          .adapt = adapt};
}

}  // namespace

const Term& sensor_non_linearity() {
  static const std::array<Term, 3> power_laws{response(raise, fix_all_but<gamma>),
                                              response(raise, fix_all_but<gamma, toe>),
                                              response(raise, fix_all_but<gamma, shoulder>)};
  static const Term term = [] {
    Term form = response(bend, fix_all_but<quadratic>);
    form.alternatives = power_laws;
    return form;
  }();
  return term;
}

}  // namespace gonio::explain::tables::terms
