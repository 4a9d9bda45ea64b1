// ct.blur on the widths of edges.
#include "volume/mechanisms/ct_blur.h"

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {

const Term& ct_blur() {
  static const Term term{.mechanism = mechanism::ct_blur,
                         .order = 200,
                         .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
                           return row.reading == Reading::width ? equation::ct_blur(value, p[0]) : value;
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
