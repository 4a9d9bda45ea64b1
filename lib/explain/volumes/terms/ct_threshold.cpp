// ct.threshold on walls: all move by one distance.
#include <algorithm>
#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::mechanism {
const Mechanism& ct_threshold();
}

namespace gonio::explain::volumes::terms {

const Term& ct_threshold() {
  static const Term term{.mechanism = mechanism::ct_threshold,
                         .order = 100,
                         .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
                           return row.reading == Reading::wall ? value + p[0] : value;
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
