// sensor.non-linearity as a quadratic of a predicted reading, stated at the table's largest value; or as a power law,
// for pictures that were coded for a screen among others: alone, with a toe, or with a shoulder.
#include "render/mechanisms/sensor_non_linearity.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "explain/tables/chart_scatter.h"
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

// A power law is how pictures are coded, far from proportion; what a sensor itself bends is the quadratic. The greys of
// a chart tell before anything is fitted: where they are read nearly in proportion, an exponent near one would only
// stand for glare on their black. True of other tables.
bool may_be_coded(const Table& table) {
  constexpr double least_departure = 0.1;
  const std::vector<double>*x = table.find("X"), *y = table.find("Y"), *z = table.find("Z");
  if (x == nullptr || y == nullptr || z == nullptr || table.observed.size() != 3) return true;
  double count = 0, sum_l = 0, sum_v = 0, squares = 0, products = 0;
  for (const std::size_t c : table.observed)
    for (std::size_t r = 0; r < table.rows(); ++r) {
      if (!is_grey({(*x)[r], (*y)[r], (*z)[r]}) || !(table.values[c][r] > 0) || !((*y)[r] > 0)) continue;
      const double l = std::log((*y)[r]), v = std::log(table.values[c][r]);
      count += 1, sum_l += l, sum_v += v, squares += l * l, products += l * v;
    }
  const double spread = squares - sum_l * sum_l / std::max(count, 1.0);
  if (!(spread > 0)) return true;
  return std::abs((products - sum_l * sum_v / count) / spread - 1) > least_departure;
}

Term response(double (*act)(double, std::span<const double>, std::span<const double>),
              void (*adapt)(const Table&, double, std::span<TermParameter>), bool (*applies)(const Table&)) {
  return {.mechanism = mechanism::sensor_non_linearity,
          .order = term_order::non_linearity,
          .models = {"sensor", "light", "volume", "expression", "probe-radiance", "chart"},
          .applies = applies,
          .act = act,
          .adapt = adapt};
}

}  // namespace

const Term& sensor_non_linearity() {
  static const std::array<Term, 3> power_laws{response(raise, fix_all_but<gamma>, may_be_coded),
                                              response(raise, fix_all_but<gamma, toe>, may_be_coded),
                                              response(raise, fix_all_but<gamma, shoulder>, may_be_coded)};
  static const Term term = [] {
    Term form = response(bend, fix_all_but<quadratic>, [](const Table&) { return true; });
    form.alternatives = power_laws;
    return form;
  }();
  return term;
}

}  // namespace gonio::explain::tables::terms
