// ct.beam-hardening on grey values: what the squares of the line integrals are reconstructed to.
#include <algorithm>
#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::mechanism {
const Mechanism& ct_beam_hardening();
}

namespace gonio::explain::volumes::terms {

const Term& ct_beam_hardening() {
  static const Term term{
      .mechanism = mechanism::ct_beam_hardening,
      .order = 200,
      .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
        return row.reading == Reading::inside || row.reading == Reading::outside ? value - p[0] * row.hardening : value;
      }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
