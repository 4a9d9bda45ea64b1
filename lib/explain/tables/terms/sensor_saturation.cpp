// sensor.saturation on a predicted reading. Equation: render/sensor_chain.h, step 10.
#include <algorithm>

#include "explain/tables/table_model.h"

namespace gonio::mechanism {
const Mechanism& sensor_saturation();
}

namespace gonio::explain::tables {

const Term& sensor_saturation() {
  static const Term term{.mechanism = mechanism::sensor_saturation,
                         .order = term_order::saturation,
                         .models = {"sensor", "light", "expression"},
                         .applies = [](const Table&) { return true; },
                         .act = [](double f, std::span<const double>,
                                   std::span<const double> p) { return p[0] == 0 ? f : std::min(f, p[0]); },
                         .adapt =
                             [](const Table&, double scale, std::span<TermParameter> p) {
                               p[0] = {0.98 * scale, 0.2 * scale, 2 * scale, 0.1 * scale};
                               p[0].as_observed = true;
                             }};
  return term;
}

}  // namespace gonio::explain::tables
