// See limits.h.
#include "goniometry/limits.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "surface/microfacet.h"

namespace gonio::goniometry {

double least_alpha(const Samples& samples) {
  std::vector<double> slopes;
  for (std::size_t r = 0; r < samples.rows(); ++r) {
    const Vec3 h = surface::half_vector(samples.wo[r], samples.wi[r]);
    if (h.z > 0) slopes.push_back(std::hypot(h.x, h.y) / h.z);
  }
  std::ranges::sort(slopes);
  const auto any_between = [&](double above, double up_to) {
    const auto found = std::ranges::upper_bound(slopes, above);
    return found != slopes.end() && *found <= up_to;
  };
  double least = 1;
  for (double alpha = 1; alpha > 1e-5; alpha /= 1.02) {
    if (slopes.empty() || slopes.front() > alpha / 2 || !any_between(alpha / 2, 1.5 * alpha)) break;
    least = alpha;
  }
  return least;
}

std::string too_narrow(double least) {
  char text[200];
  std::snprintf(text, sizeof text,
                "alpha < %.2g cannot be told from these angles: no two half vectors lie close enough to the peak; take "
                "directions around the mirror direction in smaller steps",
                least);
  return text;
}

bool turns_about_normal(const Samples& samples) {
  // Second moments of the half vectors across the normal: flat to a thousandth where they stay in one plane.
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t r = 0; r < samples.rows(); ++r) {
    const Vec3 h = surface::half_vector(samples.wo[r], samples.wi[r]);
    xx += h.x * h.x, xy += h.x * h.y, yy += h.y * h.y;
  }
  const double mean = (xx + yy) / 2, apart = std::hypot((xx - yy) / 2, xy);
  return mean - apart > 1e-3 * (mean + apart);
}

}  // namespace gonio::goniometry
