// screen.angle: of all screens.
#include "light/mechanisms/screen_angle.h"

#include <cmath>

#include "explain/polarization/polarization_term.h"
#include "explain/polarization/screens.h"

namespace gonio::explain::polarization::terms {

const Term& screen_angle() {
  static const Term term{
      .mechanism = mechanism::screen_angle,
      .forms =
          [](const Setup& setup) {
            return setup.screens.empty() ? std::vector<Form>{} : std::vector<Form>{{{"turn_rad"}}};
          },
      .set = [](State& state, const Form&, std::span<const double> p) { state.screen_turn_rad = p[0]; },
      .write =
          [](manifest::Document& document, const Setup& setup, const Form&, std::span<const double> p,
             std::span<const double> sigma) {
            for (const std::string& name : setup.screens)
              set_screen(document, name, screen_angle_key, screen_angle_rad(document, name) + p[0], sigma[0]);
          }};
  return term;
}

}  // namespace gonio::explain::polarization::terms
