// sensor.row-pattern on readings whose row in the picture is known, with one phase.
#include "render/mechanisms/sensor_row_pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {

const Term& sensor_row_pattern() {
  static const Term term{.mechanism = mechanism::sensor_row_pattern,
                         .order = term_order::row_pattern,
                         .columns = {{"row", "px", "of the picture"}},
                         .models = {"sensor", "light", "surface", "expression"},
                         .adapt = [](const Table& table, double, std::span<TermParameter> p) {
                           const std::vector<double>& row = *table.find("row");
                           const auto [least, most] = std::minmax_element(row.begin(), row.end());
                           const double span = *most - *least;
                           for (std::size_t k = 3; k < p.size(); ++k) p[k].use = TermParameter::Use::fixed;
                           p[1] = {span / 4, std::max(2.0, span / 50), 2 * span, span / 20};
                         }};
  return term;
}

}  // namespace gonio::explain::tables::terms
