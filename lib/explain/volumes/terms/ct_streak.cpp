// ct.streak on all readings: what line integrals through markers lack, reconstructed (observed.h).
#include "volume/mechanisms/ct_streak.h"

#include <algorithm>

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {

const Term& ct_streak() {
  static const Term term{
      .mechanism = mechanism::ct_streak,
      .order = 200,
      .forms = {{{"streak"}, false}, {{"floor"}, false}},
      .applies =
          [](const Observed& o) { return std::ranges::any_of(o.rows, [](const Row& r) { return r.markers != 0; }); },
      .act =
          [](double value, const Row& row, const Observed&, std::span<const double> p) {
            return equation::ct_streak(equation::ct_streak(value, p[0], row.markers), p[1],
                                       at_share(row.floor, streak_floors, p[1]));
          }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
