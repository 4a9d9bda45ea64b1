// surface.roughness: of each surface whose model has one; light from facets that stand in all directions loses its
// polarization.
#include <cmath>

#include "explain/polarization/polarization_term.h"
#include "manifest/document.h"
#include "manifest/sections/surface.h"

namespace gonio::mechanism {
const Mechanism& surface_roughness();
}

namespace gonio::explain::polarization::terms {

const Term& surface_roughness() {
  static const Term term{
      .mechanism = mechanism::surface_roughness,
      .forms =
          [](const Setup& setup) {
            std::vector<Form> forms;
            for (std::size_t k = 0; k < setup.rough.size(); ++k)
              forms.push_back({{"more"}, false, setup.rough[k].name, k, roughest});
            return forms;
          },
      .set = [](State& state, const Form& form, std::span<const double> p) { state.rougher[form.place] = p[0]; },
      .write =
          [](manifest::Document& document, const Setup& setup, const Form& form, std::span<const double> p,
             std::span<const double> sigma) {
            const double alpha = std::hypot(setup.rough[form.place].alpha, p[0]);
            manifest::Surface& surface = document.surfaces.at(form.on);
            surface.parameters["alpha"].value = {alpha};
            surface.sigma["alpha"] = {alpha > 0 ? p[0] / alpha * sigma[0] : 0};
          }};
  return term;
}

}  // namespace gonio::explain::polarization::terms
