// sensor.row-pattern on readings whose row in the picture is known. Equation: render/sensor_chain.h, step 7.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "explain/tables/table_model.h"

namespace gonio::mechanism {
const Mechanism& sensor_row_pattern();
}

namespace gonio::explain::tables {

const Term& sensor_row_pattern() {
  static const Term term{.mechanism = mechanism::sensor_row_pattern,
                         .order = term_order::row_pattern,
                         .columns = {{"row", "px", "of the picture"}},
                         .models = {"sensor", "light", "surface", "expression"},
                         .act =
                             [](double f, std::span<const double> at, std::span<const double> p) {
                               return f * (1 + p[0] * std::sin(2 * std::numbers::pi * at[0] / p[1] + p[2]));
                             },
                         .adapt =
                             [](const Table& table, double, std::span<TermParameter> p) {
                               const std::vector<double>& row = *table.find("row");
                               const auto [least, most] = std::minmax_element(row.begin(), row.end());
                               const double span = *most - *least;
                               p[1] = {span / 4, std::max(2.0, span / 50), 2 * span, span / 20};
                             }};
  return term;
}

}  // namespace gonio::explain::tables
