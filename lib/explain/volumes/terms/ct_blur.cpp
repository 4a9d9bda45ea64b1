// ct.blur on edges and on grey values near them: what line integrals lack, reconstructed at some spreads and read
// (observed.h).
#include "volume/mechanisms/ct_blur.h"

#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes {
namespace {

// Between the spreads at which it was reconstructed, linear in their squares, and beyond the last.
double between_spreads(const std::array<double, 4>& at, double spread) {
  const double square = spread * spread;
  std::size_t k = 0;
  while (k + 1 < blur_spreads.size() && spread > blur_spreads[k]) ++k;
  const double low = k == 0 ? 0 : blur_spreads[k - 1] * blur_spreads[k - 1], high = blur_spreads[k] * blur_spreads[k];
  const double from = k == 0 ? 0 : at[k - 1];
  return from + (square - low) / (high - low) * (at[k] - from);
}

}  // namespace

double blurred(double value, const Row& row, double spread, double spectrum) {
  if (row.reading != Reading::width)
    return value - between_spreads(row.blur, spread) -
           spectrum / blur_variance * between_spreads(row.blur_of_spectrum, spread);
  std::array<double, 4> squares{};
  for (std::size_t k = 0; k < squares.size(); ++k) squares[k] = row.blur[k] * row.blur[k];
  return equation::ct_blur(value, std::sqrt(std::max(0.0, between_spreads(squares, spread))));
}

namespace terms {

const Term& ct_blur() {
  static const Term term{.mechanism = mechanism::ct_blur,
                         .order = 200,
                         .of_spectrum = true,
                         .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
                           return blurred(value, row, p[0], p[1]);
                         }};
  return term;
}

}  // namespace terms
}  // namespace gonio::explain::volumes
