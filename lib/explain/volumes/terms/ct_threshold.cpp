// ct.threshold on walls: all move by one distance.
#include "volume/mechanisms/ct_threshold.h"

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {

const Term& ct_threshold() {
  static const Term term{.mechanism = mechanism::ct_threshold,
                         .order = 100,
                         .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
                           return row.reading == Reading::wall ? equation::ct_threshold(value, p[0]) : value;
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
