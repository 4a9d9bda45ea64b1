// sensor.saturation on a predicted reading.
#include "render/mechanisms/sensor_saturation.h"

#include <algorithm>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {

const Term& sensor_saturation() {
  static const Term term{.mechanism = mechanism::sensor_saturation,
                         .order = term_order::saturation,
                         .models = {"sensor", "light", "expression", "probe-radiance", "chart"},
                         .applies = [](const Table&) { return true; },
                         .adapt =
                             [](const Table&, double scale, std::span<TermParameter> p) {
                               p[0] = {0.98 * scale, 0.2 * scale, 2 * scale, 0.1 * scale};
                               p[0].as_observed = true;
                             }};
  return term;
}

}  // namespace gonio::explain::tables::terms
