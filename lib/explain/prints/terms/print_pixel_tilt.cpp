// print.pixel-tilt: along the rows, along the columns, or both; sharp at either end.
#include "print/mechanisms/print_pixel_tilt.h"

#include "explain/prints/print_term.h"

namespace gonio::explain::prints::terms {

const Term& print_pixel_tilt() {
  static const Term term{.mechanism = mechanism::print_pixel_tilt,
                         .forms =
                             [](const Sent&) {
                               return std::vector<Form>{{{"slope_x"}, false}, {{"slope_y"}, false}};
                             },
                         .bounds =
                             [](const Sent& sent) {  // four pixels at the far side
                               const double x = 4.0 / sent.printer.width_px, y = 4.0 / sent.printer.height_px;
                               return std::vector<Bounds>{{0, -x, x, 0.2 * x}, {0, -y, y, 0.2 * y}};
                             },
                         .set =
                             [](Setting& setting, const Sent&, const Form&, std::span<const double> p) {
                               setting.tilt = {p[0], p[1]};
                             }};
  return term;
}

}  // namespace gonio::explain::prints::terms
