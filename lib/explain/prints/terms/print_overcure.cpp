// print.overcure: the depth of penetration, where none is stated, or another one.
#include "print/mechanisms/print_overcure.h"

#include "explain/prints/print_term.h"
#include "manifest/sections/print.h"

namespace gonio::explain::prints::terms {

const Term& print_overcure() {
  static const Term term{
      .mechanism = mechanism::print_overcure,
      .bounds =
          [](const Sent& sent) {
            const double layer_m = sent.printer.layer_m, depth_m = sent.printer.overcure_m.value_or(0);
            return std::vector<Bounds>{{depth_m, 0, 8 * layer_m, depth_m > 0 ? 1.2 * depth_m : 0.5 * layer_m}};
          },
      .set =
          [](Setting& setting, const Sent&, const Form&, std::span<const double> p) {
            if (p[0] > 0)
              setting.printer.overcure_m = p[0];
            else
              setting.printer.overcure_m.reset();
          },
      .write = [](manifest::Print& print, const Sent&, std::span<const double> p,
                  std::span<const double>) { print.overcure_m = p[0]; }};
  return term;
}

}  // namespace gonio::explain::prints::terms
