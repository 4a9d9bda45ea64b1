// ct.scatter on all readings: what line integrals lack, reconstructed at some shares (observed.h).
#include "volume/mechanisms/ct_scatter.h"

#include <algorithm>
#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {
namespace {

// Between the shares at which it was reconstructed, linear in the logarithm of the share.
double lacks(const Row& row, double share) {
  if (!(share > scatter_shares.front())) return row.scatter.front();
  std::size_t k = 0;
  while (k + 2 < scatter_shares.size() && share > scatter_shares[k + 1]) ++k;
  const double t = std::log(share / scatter_shares[k]) / std::log(scatter_shares[k + 1] / scatter_shares[k]);
  return row.scatter[k] + std::min(t, 1.0) * (row.scatter[k + 1] - row.scatter[k]);
}

}  // namespace

const Term& ct_scatter() {
  static const Term term{.mechanism = mechanism::ct_scatter,
                         .order = 200,
                         .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
                           return equation::ct_scatter(value, p[0], lacks(row, p[0]));
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
