// Where the radial polynomial stops being one-to-one: the smallest positive root u = r^2 of d(r R) / dr,
//   1 + 3 k1 u + 5 k2 u^2 + 7 k3 u^3 = 0,
// bracketed between the extrema of the cubic and found by bisection, which is exact to the last bit and cannot cycle.
#include "camera/lens_terms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace gonio::camera {

double one_to_one_radius(double k1, double k2, double k3) {
  const double a = 3 * k1, b = 5 * k2, c = 7 * k3;
  const auto slope = [&](double u) { return 1 + u * (a + u * (b + u * c)); };
  // Extrema: a + 2 b u + 3 c u^2 = 0, solved without cancellation (Press et al., Numerical Recipes, 5.6).
  std::vector<double> knots;
  if (const double disc = b * b - 3 * a * c; disc >= 0) {
    const double q = -(b + std::copysign(std::sqrt(disc), b));
    if (q != 0) knots.push_back(a / q);
    if (c != 0) knots.push_back(q / (3 * c));
  }
  std::erase_if(knots, [](double u) { return !(u > 0) || !std::isfinite(u); });
  std::sort(knots.begin(), knots.end());
  knots.push_back(1e12);  // r = 10^6: a ray 0.2 arc seconds from the image plane
  double low = 0;
  for (const double knot : knots) {
    if (slope(knot) <= 0) {
      double high = knot;
      while (true) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) return std::sqrt(low);
        (slope(middle) > 0 ? low : high) = middle;
      }
    }
    low = knot;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace gonio::camera
