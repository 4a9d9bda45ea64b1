// light.inverse-square along a bench: D is the distance that belongs to the smallest
// distance_m. Where distance_m is the lamp's own distance, nearness is found as 1 / d_least; another value says that
// the lamp's seat is not where the scale begins.
#include "light/mechanisms/light_inverse_square.h"

#include <algorithm>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {

const Term& light_inverse_square() {
  static const Term term{
      .mechanism = mechanism::light_inverse_square,
      .order = term_order::light + 1,
      .columns = {{.name = "distance_m", .unit = "m", .meaning = "along the axis from the lamp", .from_least = true}},
      .models = {"sensor", "volume", "surface", "expression"},
      .adapt = [](const Table& table, double, std::span<TermParameter> p) {
        const std::vector<double>& d = *table.find("distance_m");
        const auto [least, most] = std::minmax_element(d.begin(), d.end());
        p[0].start = 0.2 / (*most - *least);
        p[0].upper = std::max(p[0].upper, 100 / (*most - *least));
        p[0].size = p[0].start;
      }};
  return term;
}

}  // namespace gonio::explain::tables::terms
