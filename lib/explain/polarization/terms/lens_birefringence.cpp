// lens.birefringence: light along the radius late, or early. Where no light is circular the two look alike.
#include "photograph/mechanisms/lens_birefringence.h"

#include "explain/polarization/polarization_term.h"

namespace gonio::explain::polarization::terms {

const Term& lens_birefringence() {
  static const Term term{
      .mechanism = mechanism::lens_birefringence,
      .forms =
          [](const Setup&) {
            return std::vector<Form>{{.parameters = {"retardance_rad"}, .side = 1},
                                     {.parameters = {"retardance_rad"}, .side = -1}};
          },
      .set = [](State& state, const Form&, std::span<const double> p) { state.array.retardance_rad = p[0]; }};
  return term;
}

}  // namespace gonio::explain::polarization::terms
