// sensor.crosstalk: between samples behind other polarizers.
#include "render/mechanisms/sensor_crosstalk.h"

#include "explain/polarization/polarization_term.h"

namespace gonio::explain::polarization::terms {

const Term& sensor_crosstalk() {
  static const Term term{.mechanism = mechanism::sensor_crosstalk,
                         .forms = [](const Setup&) { return std::vector<Form>{{{"share"}}}; },
                         .set = [](State& state, const Form&, std::span<const double> p) { state.array.share = p[0]; }};
  return term;
}

}  // namespace gonio::explain::polarization::terms
