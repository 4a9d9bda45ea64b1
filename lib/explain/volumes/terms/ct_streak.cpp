// ct.streak on grey values: what the squares of the paths through markers are reconstructed to.
#include <algorithm>
#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::mechanism {
const Mechanism& ct_streak();
}

namespace gonio::explain::volumes::terms {

const Term& ct_streak() {
  static const Term term{
      .mechanism = mechanism::ct_streak,
      .order = 200,
      .applies =
          [](const Observed& o) { return std::ranges::any_of(o.rows, [](const Row& r) { return r.markers != 0; }); },
      .act =
          [](double value, const Row& row, const Observed&, std::span<const double> p) {
            return row.reading == Reading::inside || row.reading == Reading::outside ? value - p[0] * row.markers
                                                                                     : value;
          }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
