// Trilinear samples of voxels that lie in memory, and how the noise of two such samples correlates.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "geom/vector.h"

namespace gonio::volume {

// A box of voxels: part of a volume whose indices run from `low` to `high`; what is not within both has no value.
struct Block {
  const float* values = nullptr;        // i fastest
  std::array<std::size_t, 3> size{};
  std::array<std::ptrdiff_t, 3> first{};  // the volume's index of values[0]
  Vec3 low{}, high{};

  double at(Vec3 index) const {
    if (!(index.x >= low.x && index.y >= low.y && index.z >= low.z && index.x <= high.x && index.y <= high.y &&
          index.z <= high.z))
      return std::numeric_limits<double>::quiet_NaN();
    std::array<std::size_t, 3> cell{}, next{};
    std::array<double, 3> f{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = index[static_cast<int>(a)] - static_cast<double>(first[a]);
      cell[a] = std::min(static_cast<std::size_t>(x), size[a] - 1);
      next[a] = std::min(cell[a] + 1, size[a] - 1) - cell[a];
      f[a] = x - static_cast<double>(cell[a]);
    }
    const std::size_t row = size[0], slice = size[0] * size[1];
    const float* v = values + cell[2] * slice + cell[1] * row + cell[0];
    const auto line = [&](const float* p) { return p[0] + f[0] * (static_cast<double>(p[next[0]]) - p[0]); };
    const auto face = [&](const float* p) {
      const double one = line(p);
      return one + f[1] * (line(p + next[1] * row) - one);
    };
    const double one = face(v);
    return one + f[2] * (face(v + next[2] * slice) - one);
  }
};

// Along one axis: covariance of linear samples at a and b of noise with unit variance, whose correlation k voxels apart
// is q^(k^2).
class AxisCovariance {
 public:
  explicit AxisCovariance(double neighbour) {
    const double q = std::clamp(neighbour, -0.5, 0.999);
    for (std::size_t k = 0; k < table_.size(); ++k) {
      const double n = static_cast<double>(k);
      table_[k] = k < 2 ? (k == 0 ? 1 : q) : (q > 0 ? std::pow(q, n * n) : 0);
    }
  }
  double operator()(double a, double b) const {
    const double ia = std::floor(a), ib = std::floor(b), fa = a - ia, fb = b - ib;
    const auto d = static_cast<std::ptrdiff_t>(ib - ia);
    return ((1 - fa) * (1 - fb) + fa * fb) * of(d) + (1 - fa) * fb * of(d + 1) + fa * (1 - fb) * of(d - 1);
  }
  // Of voxels k apart.
  double of(std::ptrdiff_t k) const {
    const auto n = static_cast<std::size_t>(k < 0 ? -k : k);
    return n < table_.size() ? table_[n] : 0;
  }

 private:
  std::array<double, 32> table_{};
};

inline double covariance_of(const AxisCovariance& axis, Vec3 a, Vec3 b) {
  return axis(a.x, b.x) * axis(a.y, b.y) * axis(a.z, b.z);
}

}  // namespace gonio::volume
