// ct.scatter on all readings: what line integrals lack, reconstructed at some shares (observed.h).
#include "volume/mechanisms/ct_scatter.h"

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {

const Term& ct_scatter() {
  static const Term term{.mechanism = mechanism::ct_scatter,
                         .order = 200,
                         .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
                           return equation::ct_scatter(value, p[0], at_share(row.scatter, scatter_shares, p[0]));
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
