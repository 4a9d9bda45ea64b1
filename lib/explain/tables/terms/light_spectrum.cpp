// light.spectrum on readings with a channel and a time; channels 0, 1, 2 are red, green, blue. The time enters as a
// share of the table's whole.
#include "light/mechanisms/light_spectrum.h"

#include <algorithm>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {

const Term& light_spectrum() {
  static const Term term{.mechanism = mechanism::light_spectrum,
                         .order = term_order::light + 2,
                         .columns = {{.name = "time_s",
                                      .unit = "s",
                                      .meaning = "of the recording, from any moment",
                                      .from_least = true,
                                      .as_share = true},
                                     {"channel", "1", "0, 1, 2"}},
                         .models = {"sensor", "light", "surface", "expression"}};
  return term;
}

}  // namespace gonio::explain::tables::terms
