// print.membrane: tops that are cut.
#include "print/mechanisms/print_membrane.h"

#include "explain/prints/print_term.h"

namespace gonio::explain::prints::terms {

const Term& print_membrane() {
  static const Term term{
      .mechanism = mechanism::print_membrane,
      .bounds =
          [](const Sent& sent) {
            const double layer_m = sent.printer.layer_m;
            return std::vector<Bounds>{{0, 0, 0.9 * layer_m, 0.12 * layer_m}};
          },
      .set = [](Setting& setting, const Sent&, const Form&, std::span<const double> p) { setting.cut_m = p[0]; }};
  return term;
}

}  // namespace gonio::explain::prints::terms
