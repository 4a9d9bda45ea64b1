// sensor.shutter on a reading that is proportional to the exposure.
#include "render/mechanisms/sensor_shutter.h"

#include <algorithm>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {

const Term& sensor_shutter() {
  static const Term term{.mechanism = mechanism::sensor_shutter,
                         .order = term_order::shutter,
                         .columns = {{"exposure_s", "s", "as it was set"}},
                         .models = {"sensor", "light", "expression"},
                         .adapt = [](const Table& table, double, std::span<TermParameter> p) {
                           const std::vector<double>& exposure = *table.find("exposure_s");
                           const double least = std::max(1e-12, *std::min_element(exposure.begin(), exposure.end()));
                           p[0] = {0.02 * least, -0.9 * least, std::max(0.01, 2 * least), 0.02 * least};
                         }};
  return term;
}

}  // namespace gonio::explain::tables::terms
