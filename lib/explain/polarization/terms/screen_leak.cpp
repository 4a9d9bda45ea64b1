// screen.leak: of all screens.
#include "light/mechanisms/screen_leak.h"

#include "explain/polarization/polarization_term.h"
#include "explain/polarization/screens.h"

namespace gonio::explain::polarization::terms {

const Term& screen_leak() {
  static const Term term{.mechanism = mechanism::screen_leak,
                         .forms =
                             [](const Setup& setup) {
                               return setup.screens.empty() ? std::vector<Form>{} : std::vector<Form>{{{"leak"}}};
                             },
                         .set = [](State& state, const Form&, std::span<const double> p) { state.screen_leak = p[0]; },
                         .write =
                             [](manifest::Document& document, const Setup& setup, const Form&,
                                std::span<const double> p, std::span<const double> sigma) {
                               for (const std::string& name : setup.screens) {
                                 const double before = screen_degree(document, name),
                                              after = equation::screen_leak(before, p[0]);
                                 const double slope = 2 * before / ((1 + p[0]) * (1 + p[0]));
                                 set_screen(document, name, screen_degree_key, after, slope * sigma[0]);
                               }
                             }};
  return term;
}

}  // namespace gonio::explain::polarization::terms
