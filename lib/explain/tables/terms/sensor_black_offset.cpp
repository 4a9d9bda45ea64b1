// sensor.black-offset on a predicted reading. Reflectances are readings that
// were divided by what fell on the sample: an offset of the readings is none of theirs, and a table of reflectances
// does not say by how much each was divided.
#include "render/mechanisms/sensor_black_offset.h"

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {

const Term& sensor_black_offset() {
  static const Term term{.mechanism = mechanism::sensor_black_offset,
                         .order = term_order::black_offset,
                         .models = {"sensor", "light", "volume", "expression", "probe-radiance"},
                         .applies = [](const Table&) { return true; },
                         .adapt =
                             [](const Table&, double scale, std::span<TermParameter> p) {
                               p[0] = {0.01 * scale, -0.2 * scale, 0.2 * scale, 0.01 * scale};
                               p[0].as_observed = true;
                             }};
  return term;
}

}  // namespace gonio::explain::tables::terms
