// ct.ring on grey values: the rings that other sectors show.
#include "volume/mechanisms/ct_ring.h"

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {

const Term& ct_ring() {
  static const Term term{.mechanism = mechanism::ct_ring,
                         .order = 300,
                         .applies = [](const Observed& o) { return o.ring_rms > 0; },
                         .act =
                             [](double value, const Row& row, const Observed&, std::span<const double> p) {
                               return is_grey(row.reading) ? equation::ct_ring(value, p[0], row.ring) : value;
                             }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
