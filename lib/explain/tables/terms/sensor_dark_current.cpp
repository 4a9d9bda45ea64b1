// sensor.dark-current on readings whose exposure varies. Where the radiances are unknown it is one with them.
#include <algorithm>

#include "explain/tables/table_model.h"

namespace gonio::mechanism {
const Mechanism& sensor_dark_current();
}

namespace gonio::explain::tables::terms {

const Term& sensor_dark_current() {
  static const Term term{.mechanism = mechanism::sensor_dark_current,
                         .order = term_order::dark_current,
                         .columns = {{"exposure_s", "s", "how long charge was gathered"}},
                         .models = {"sensor", "expression"},
                         .adapt = [](const Table& table, double scale, std::span<TermParameter> p) {
                           const std::vector<double>& exposure = *table.find("exposure_s");
                           const double longest = std::max(1e-12, *std::ranges::max_element(exposure));
                           const double rate = scale / longest;
                           p[0] = {0.01 * rate, -0.2 * rate, 0.2 * rate, 0.01 * rate};
                         }};
  return term;
}

}  // namespace gonio::explain::tables::terms
