// light.spectrum on readings with a channel and a time; channels 0, 1, 2 are red, green, blue. The time enters as a
// share of the table's whole.
#include <algorithm>

#include "explain/tables/table_model.h"

namespace gonio::mechanism {
const Mechanism& light_spectrum();
}

namespace gonio::explain::tables {

const Term& light_spectrum() {
  static const Term term{.mechanism = mechanism::light_spectrum,
                         .order = term_order::light + 2,
                         .columns = {{.name = "time_s",
                                      .unit = "s",
                                      .meaning = "of the recording, from any moment",
                                      .from_least = true,
                                      .as_share = true},
                                     {"channel", "1", "0, 1, 2"}},
                         .models = {"sensor", "light", "surface", "expression"},
                         .act = [](double f, std::span<const double> at, std::span<const double> p) {
                           if (at[1] == 0) return f * (1 + p[0] * at[0]);
                           return at[1] == 2 ? f * (1 + p[1] * at[0]) : f;
                         }};
  return term;
}

}  // namespace gonio::explain::tables
