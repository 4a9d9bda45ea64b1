// surface.coating: on each smooth mirror of metal; a film of magnesium fluoride, or of any index.
#include "explain/polarization/polarization_term.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::mechanism {
const Mechanism& surface_coating();
}

namespace gonio::explain::polarization::terms {

const Term& surface_coating() {
  static const Term term{.mechanism = mechanism::surface_coating,
                         .forms =
                             [](const Setup& setup) {
                               std::vector<Form> forms;
                               for (std::size_t k = 0; k < setup.mirrors.size(); ++k) {
                                 forms.push_back({{"film_m"}, false, setup.mirrors[k].name, k});
                                 forms.push_back({{"film_m", "film_eta"}, true, setup.mirrors[k].name, k});
                               }
                               return forms;
                             },
                         .set =
                             [](State& state, const Form& form, std::span<const double> p) {
                               state.film[form.place] = {p[0], p[1]};
                             },
                         .write =
                             [](manifest::Document& document, const Setup&, const Form& form, std::span<const double> p,
                                std::span<const double> sigma) {
                               const mechanism::Mechanism& m = mechanism::surface_coating();
                               manifest::MechanismUse& use = document.mechanisms[m.id];
                               use.on.push_back(form.on);
                               for (std::size_t k = 0; k < p.size(); ++k) {
                                 use.parameters[m.parameters[k].name].value.push_back(p[k]);
                                 use.sigma[m.parameters[k].name].push_back(sigma[k]);
                               }
                             }};
  return term;
}

}  // namespace gonio::explain::polarization::terms
