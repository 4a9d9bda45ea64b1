#include "surface/dipole_distances.h"

#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::surface {
namespace {

// d with (z / d) exp(-s (d - z)) = tail.
double distance_of_tail(double depth, double s, double tail) {
  if (s == 0) return depth / tail;
  const double m = std::log(s * depth / tail) + s * depth;
  double y = m > 1 ? m : std::exp(m);
  for (int i = 0; i < 20; ++i) {
    const double next = y * (1 + m - std::log(y)) / (1 + y);
    const bool done = std::abs(next - y) <= 1e-14 * y;
    y = next;
    if (done) break;
  }
  return std::max(depth, y / s);
}

}  // namespace

double DipoleDistances::tail(const Source& source, double distance_m) const {
  const double d = std::hypot(distance_m, source.depth_m);
  return source.depth_m / d * std::exp(-sigma_tr_ * (d - source.depth_m));
}

double DipoleDistances::tail(double distance_m) const {
  double sum = 0;
  for (const Source& source : sources_)
    if (source.share > 0) sum += source.share * tail(source, distance_m);
  return sum;
}

double DipoleDistances::reach_m(double remaining) const {
  double low = 0, high = 0;
  for (const Source& source : sources_)
    if (source.share > 0) high = std::max(high, distance_of_tail(source.depth_m, sigma_tr_, remaining));
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (tail(middle) > remaining ? low : high) = middle;
  }
  return high;
}

double DipoleDistances::sample(double u) const {
  const bool first = u < sources_[0].share;
  const Source& source = sources_[first ? 0 : 1];
  const double v = first ? u / sources_[0].share : (u - sources_[0].share) / sources_[1].share;
  const double least = tail(source, cut_m_), d = distance_of_tail(source.depth_m, sigma_tr_, 1 - v * (1 - least));
  return std::min(cut_m_, std::sqrt(std::max(0.0, (d - source.depth_m) * (d + source.depth_m))));
}

void DipoleDistances::cut(double reach_m) {
  cut_m_ = reach_m;
  for (std::size_t k = 0; k < 2; ++k) {
    const Source& source = sources_[k];
    strength_[k] = source.share > 0 ? source.share * source.depth_m / (2 * pi * (1 - tail(source, cut_m_))) : 0;
  }
}

double DipoleDistances::density(double distance_m) const {
  if (distance_m > cut_m_) return 0;
  double sum = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const double z = sources_[k].depth_m, d2 = distance_m * distance_m + z * z, d = std::sqrt(d2);
    if (strength_[k] > 0) sum += strength_[k] * (1 + sigma_tr_ * d) * std::exp(-sigma_tr_ * (d - z)) / (d2 * d);
  }
  return sum;
}

}  // namespace gonio::surface
