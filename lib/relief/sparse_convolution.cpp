// See sparse_convolution.h.
#include "relief/sparse_convolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace gonio::relief {
namespace {

constexpr int impulses = 30;

// rnd(t_k) for k = 0 ... 65535.
const std::array<float, 65536>& sequence() {
  static const std::array<float, 65536> numbers = [] {
    std::array<float, 65536> made{};
    std::uint32_t t = 0;
    for (float& number : made) {
      t = (3125 * t + 49) & 0xffffu;
      number = static_cast<float>(t) / 65536.0f;  // exact
    }
    return made;
  }();
  return numbers;
}

// The impulses of the eight cells from `first` on. Places that are asked for one after the other mostly lie among the
// same.
struct Impulses {
  static constexpr std::size_t count = 8 * impulses;
  Vec3 first{std::numeric_limits<double>::quiet_NaN(), 0, 0};
  std::array<double, count> height{}, x{}, y{}, z{};

  void gather(Vec3 from) {
    first = from;
    const auto& numbers = sequence();
    std::size_t k = 0;
    for (int i = 0; i < 8; ++i) {
      const Vec3 q =
          first + Vec3{static_cast<double>(i & 1), static_cast<double>(i >> 1 & 1), static_cast<double>(i >> 2)};
      const auto place =
          static_cast<std::int64_t>(q.x) + 1000 * static_cast<std::int64_t>(q.y) + 576 * static_cast<std::int64_t>(q.z);
      for (std::int64_t j = 1; j <= impulses; ++j, ++k) {
        const auto n = static_cast<std::uint32_t>(4 * (impulses * place + j));  // modulo 2^32, hence also modulo 65536
        height[k] = numbers[n & 0xffffu] * (j % 2 == 0 ? 1 : -1);
        x[k] = q.x + numbers[(n + 1) & 0xffffu];
        y[k] = q.y + numbers[(n + 2) & 0xffffu];
        z[k] = q.z + numbers[(n + 3) & 0xffffu];
      }
    }
  }

  double sum(Vec3 p) const {
    std::array<double, count> left;
    for (std::size_t k = 0; k < count; ++k) {
      const double dx = x[k] - p.x, dy = y[k] - p.y, dz = z[k] - p.z;
      left[k] = 1 - 4 * (dx * dx + dy * dy + dz * dz);
    }
    double total = 0;
    for (std::size_t k = 0; k < count; ++k)
      if (left[k] > 0) total += height[k] * (left[k] * left[k] * left[k]);
    return total;
  }
};

}  // namespace

double published_noise(Vec3 cells) {
  thread_local Impulses near;
  const Vec3 first{std::floor(cells.x - 0.5), std::floor(cells.y - 0.5), std::floor(cells.z - 0.5)};
  if (!(near.first == first)) near.gather(first);
  return 4 / (5 * std::cbrt(static_cast<double>(impulses))) * near.sum(cells);
}

double published_noise_grey(double noise, double amplitude) {
  return std::clamp(amplitude / 2 * noise + 0.5, 0.0, 1.0);
}

double published_noise_grey(Vec3 cells, double amplitude) {
  return published_noise_grey(published_noise(cells), amplitude);
}

}  // namespace gonio::relief
