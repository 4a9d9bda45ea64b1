// polarizer.angle: all axes alike, or each its own.
#include "photograph/mechanisms/polarizer_angle.h"

#include "explain/polarization/polarization_term.h"

namespace gonio::explain::polarization::terms {

const Term& polarizer_angle() {
  static const Term term{.mechanism = mechanism::polarizer_angle,
                         .forms =
                             [](const Setup&) {
                               return std::vector<Form>{
                                   {{"turn_rad"}}, {{"turn_rad", "turn_45_rad", "turn_90_rad", "turn_135_rad"}, true}};
                             },
                         .set =
                             [](State& state, const Form&, std::span<const double> p) {
                               state.array.turn_rad = p[0], state.array.turn_45_rad = p[1];
                               state.array.turn_90_rad = p[2], state.array.turn_135_rad = p[3];
                             }};
  return term;
}

}  // namespace gonio::explain::polarization::terms
