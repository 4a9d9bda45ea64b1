// See tile_term.h.
#include "explain/tables/tile_term.h"

#include <cmath>

namespace gonio::mechanism {
const Mechanism& reference_tile();
}

namespace gonio::explain::tables {
namespace {

double act(double f, std::span<const double> at, std::span<const double> p) {
  const double in = 1 - std::cos(at[0]), out = 1 - std::cos(at[1]);
  return f * (1 + p[0] * in * in + p[1] * out * out);
}

void at_least_zero(std::span<TermParameter> p) {
  for (TermParameter& number : p) number.lower = 0;
}
void fix(TermParameter& number) {
  number.start = 0;
  number.use = TermParameter::Use::fixed;
}

void both(const Table&, double, std::span<TermParameter> p) {
  at_least_zero(p);
}
void incidence_alone(const Table&, double, std::span<TermParameter> p) {
  at_least_zero(p);
  fix(p[1]);
}
void exitance_alone(const Table&, double, std::span<TermParameter> p) {
  at_least_zero(p);
  fix(p[0]);
}

}  // namespace

Term tile_term(bool incidence, bool exitance) {
  return {.mechanism = mechanism::reference_tile,
          .order = term_order::reference,
          .columns = {{.name = "theta_i", .unit = "rad", .meaning = "incidence", .needed = incidence},
                      {.name = "theta_o", .unit = "rad", .meaning = "exitance", .needed = exitance}},
          .models = {"surface"},
          .act = act,
          .adapt = incidence && exitance ? both
                   : incidence           ? incidence_alone
                                         : exitance_alone};
}

}  // namespace gonio::explain::tables
