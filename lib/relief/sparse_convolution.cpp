// See sparse_convolution.h.
#include "relief/sparse_convolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace gonio::relief {
namespace {

constexpr std::int64_t impulses = 30;

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

double cubic(Vec3 v) {
  const double left = 1 - 4 * dot(v, v);
  return left > 0 ? left * left * left : 0;
}

}  // namespace

double published_noise(Vec3 cells) {
  const Vec3 first{std::floor(cells.x - 0.5), std::floor(cells.y - 0.5), std::floor(cells.z - 0.5)};
  const auto& numbers = sequence();
  double sum = 0;
  for (int i = 0; i < 8; ++i) {
    const Vec3 q =
        first + Vec3{static_cast<double>(i & 1), static_cast<double>(i >> 1 & 1), static_cast<double>(i >> 2)};
    const auto place =
        static_cast<std::int64_t>(q.x) + 1000 * static_cast<std::int64_t>(q.y) + 576 * static_cast<std::int64_t>(q.z);
    for (std::int64_t j = 1; j <= impulses; ++j) {
      const auto n = static_cast<std::uint32_t>(4 * (impulses * place + j));  // modulo 2^32, hence also modulo 65536
      const double height = numbers[n & 0xffffu] * (j % 2 == 0 ? 1 : -1);
      const double x = numbers[(n + 1) & 0xffffu], y = numbers[(n + 2) & 0xffffu], z = numbers[(n + 3) & 0xffffu];
      sum += height * cubic(q + Vec3{x, y, z} - cells);
    }
  }
  return 4 / (5 * std::cbrt(static_cast<double>(impulses))) * sum;
}

double published_noise_grey(double noise, double amplitude) {
  return std::clamp(amplitude / 2 * noise + 0.5, 0.0, 1.0);
}

double published_noise_grey(Vec3 cells, double amplitude) {
  return published_noise_grey(published_noise(cells), amplitude);
}

}  // namespace gonio::relief
