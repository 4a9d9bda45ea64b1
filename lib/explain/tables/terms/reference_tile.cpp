// reference.tile on readings whose angles are known; tables of reflectance: explain/tables/tile_term.h.
#include <cmath>

#include "explain/tables/table_model.h"

namespace gonio::mechanism {
const Mechanism& reference_tile();
}

namespace gonio::explain::tables {

const Term& reference_tile() {
  static const Term term{.mechanism = mechanism::reference_tile,
                         .order = term_order::reference,
                         .columns = {{"theta_i", "rad", "incidence"},
                                     {.name = "theta_o", .unit = "rad", .meaning = "exitance", .needed = false}},
                         .models = {"expression"},
                         .act =
                             [](double f, std::span<const double> at, std::span<const double> p) {
                               const double in = 1 - std::cos(at[0]), out = std::isnan(at[1]) ? 0 : 1 - std::cos(at[1]);
                               return f * (1 + p[0] * in * in + p[1] * out * out);
                             },
                         .adapt =
                             [](const Table& table, double, std::span<TermParameter> p) {
                               if (table.varies("theta_o")) return;
                               p[1].start = 0;
                               p[1].use = TermParameter::Use::fixed;
                             }};
  return term;
}

}  // namespace gonio::explain::tables
