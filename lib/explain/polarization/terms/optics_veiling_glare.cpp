// optics.veiling-glare: reflections at nearly normal incidence inside the lens keep their polarization, so that the
// veil has the picture's mean Stokes vector, and a sample the mean of those behind the same polarizer.
#include "render/mechanisms/optics_veiling_glare.h"

#include "explain/polarization/polarization_term.h"

namespace gonio::explain::polarization::terms {

const Term& optics_veiling_glare() {
  static const Term term{.mechanism = mechanism::optics_veiling_glare,
                         .forms = [](const Setup&) { return std::vector<Form>{{{"share"}}}; },
                         .set = [](State& state, const Form&, std::span<const double> p) { state.veil = p[0]; }};
  return term;
}

}  // namespace gonio::explain::polarization::terms
