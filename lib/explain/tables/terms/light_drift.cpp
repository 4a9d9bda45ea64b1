// light.drift on any reading with a time.
#include "light/mechanisms/light_drift.h"

#include <algorithm>
#include <cmath>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {

const Term& light_drift() {
  static const Term term{
      .mechanism = mechanism::light_drift,
      .order = term_order::light,
      .columns = {{.name = "time_s", .unit = "s", .meaning = "of the recording, from any moment", .from_least = true}},
      .models = {"sensor", "light", "volume", "surface", "expression", "probe-radiance"},
      .adapt = [](const Table& table, double, std::span<TermParameter> p) {
        const std::vector<double>& time = *table.find("time_s");
        const auto [least, most] = std::minmax_element(time.begin(), time.end());
        const double span = *most - *least;
        p[1] = {span / 3, span / 50, 5 * span, span / 3};
      }};
  return term;
}

}  // namespace gonio::explain::tables::terms
