// print.shrinkage: places and heights.
#include "print/mechanisms/print_shrinkage.h"

#include "explain/prints/print_term.h"

namespace gonio::explain::prints::terms {

const Term& print_shrinkage() {
  static const Term term{.mechanism = mechanism::print_shrinkage,
                         .set =
                             [](Setting& setting, const Sent&, const Form&, std::span<const double> p) {
                               setting.shrinkage = {p[0], p[1], p[2]};
                             },
                         .gradual = true};
  return term;
}

}  // namespace gonio::explain::prints::terms
