// See sparse_convolution.h.
#include "relief/sparse_convolution.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gonio::relief {
namespace {

constexpr std::int64_t impulses = 30;

class Generator {
 public:
  explicit Generator(std::int64_t seed)
      : t_(static_cast<std::uint32_t>(seed) & 0xffffu) {}  // modulo 65536, also below 0
  double next() {
    t_ = (3125 * t_ + 49) & 0xffffu;
    return t_ / 65536.0;
  }

 private:
  std::uint32_t t_;
};

double cubic(Vec3 v) {
  const double left = 1 - 4 * dot(v, v);
  return left > 0 ? left * left * left : 0;
}

}  // namespace

double published_noise(Vec3 cells) {
  const Vec3 first{std::floor(cells.x - 0.5), std::floor(cells.y - 0.5), std::floor(cells.z - 0.5)};
  double sum = 0;
  for (int i = 0; i < 8; ++i) {
    const Vec3 q =
        first + Vec3{static_cast<double>(i & 1), static_cast<double>(i >> 1 & 1), static_cast<double>(i >> 2)};
    const auto place =
        static_cast<std::int64_t>(q.x) + 1000 * static_cast<std::int64_t>(q.y) + 576 * static_cast<std::int64_t>(q.z);
    for (std::int64_t j = 1; j <= impulses; ++j) {
      Generator random(4 * (impulses * place + j));
      const double height = random.next() * (j % 2 == 0 ? 1 : -1);
      const double x = random.next(), y = random.next(), z = random.next();
      sum += height * cubic(q + Vec3{x, y, z} - cells);
    }
  }
  return 4 / (5 * std::cbrt(static_cast<double>(impulses))) * sum;
}

double published_noise_grey(Vec3 cells, double amplitude) {
  return std::clamp(amplitude / 2 * published_noise(cells) + 0.5, 0.0, 1.0);
}

}  // namespace gonio::relief
