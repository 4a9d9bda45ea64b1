// polarizer.leak: of all four.
#include "photograph/mechanisms/polarizer_leak.h"

#include "explain/polarization/polarization_term.h"

namespace gonio::explain::polarization::terms {

const Term& polarizer_leak() {
  static const Term term{.mechanism = mechanism::polarizer_leak,
                         .forms = [](const Setup&) { return std::vector<Form>{{{"leak"}}}; },
                         .set = [](State& state, const Form&, std::span<const double> p) { state.array.leak = p[0]; }};
  return term;
}

}  // namespace gonio::explain::polarization::terms
