// ct.scatter on grey values: what exp(p) - 1 of the line integrals p is reconstructed to.
#include <algorithm>
#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::mechanism {
const Mechanism& ct_scatter();
}

namespace gonio::explain::volumes::terms {

const Term& ct_scatter() {
  static const Term term{
      .mechanism = mechanism::ct_scatter,
      .order = 200,
      .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
        return row.reading == Reading::inside || row.reading == Reading::outside ? value - p[0] * row.scatter : value;
      }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
