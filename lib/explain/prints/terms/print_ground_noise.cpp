// print.ground-noise: nothing that a simulation could predict; it is asked apart (explain/prints/ground.h).
#include "print/mechanisms/print_ground_noise.h"

#include "explain/prints/print_term.h"

namespace gonio::explain::prints::terms {

const Term& print_ground_noise() {
  static const Term term{.mechanism = mechanism::print_ground_noise,
                         .bounds =
                             [](const Sent& sent) {
                               const double pixel_m = sent.printer.pixel_m.x, layer_m = sent.printer.layer_m;
                               return std::vector<Bounds>{{0, 0, 10 * layer_m, 0.05 * layer_m},
                                                          {2 * pixel_m, 0, 100 * pixel_m, 2 * pixel_m}};
                             },
                         .set = [](Setting&, const Sent&, const Form&, std::span<const double>) {},
                         .random = true};
  return term;
}

}  // namespace gonio::explain::prints::terms
