#include "relief/sparse_convolution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace gonio::relief {
namespace {

// Reckoned by hand for one impulse: the cell at the origin, its first impulse, n = 4. From t_0 = 0:
//   49; 3125 * 49 + 49 = 153174 = 2 * 65536 + 22102; 59391; 64508; 64349; 26226; 36299; 57144 (t_1 ... t_8).
// Its height is t_5, its place t_6, t_7, t_8, over 65536. There the noise is that height and what the other impulses of
// the eight cells add, each of which is drawn from the sequence's beginning.
TEST(PublishedNoise, ItsImpulsesLieWhereTheGeneratorSays) {
  const auto number = [](std::int64_t k) {  // rnd(t_k)
    std::int64_t t = 0;
    for (std::int64_t i = 0; i <= (k % 65536 + 65536) % 65536; ++i) t = (3125 * t + 49) % 65536;
    return static_cast<double>(t) / 65536;
  };
  const Vec3 place{26226 / 65536.0, 36299 / 65536.0, 57144 / 65536.0};
  const double height = -64349 / 65536.0, factor = 4 / (5 * std::cbrt(30.0));
  double others = 0;
  for (int q = 0; q < 8 * 30; ++q) {
    const std::int64_t cx = (q / 30 & 1) - 1 + (place.x >= 0.5), cy = (q / 30 >> 1 & 1) - 1 + (place.y >= 0.5),
                       cz = (q / 30 >> 2) - 1 + (place.z >= 0.5), j = q % 30 + 1;
    if (cx == 0 && cy == 0 && cz == 0 && j == 1) continue;
    const std::int64_t n = 4 * (30 * (cx + 1000 * cy + 576 * cz) + j);
    const Vec3 d = Vec3{static_cast<double>(cx) + number(n + 1), static_cast<double>(cy) + number(n + 2),
                        static_cast<double>(cz) + number(n + 3)} -
                   place;
    const double left = 1 - 4 * dot(d, d);
    if (left > 0) others += (j % 2 == 0 ? 1 : -1) * number(n) * left * left * left;
  }
  EXPECT_NEAR(published_noise(place), factor * (height + others), 1e-12);
}

// Cells recur with the generator's period, as published: 65536 / (4 * 30) is no whole number, but 16384 cells along x
// move every seed by a multiple of it.
TEST(PublishedNoise, RecursAfter16384Cells) {
  Random random(1, 2);
  for (int k = 0; k < 20; ++k) {
    const Vec3 p{20 * random.uniform(), 20 * random.uniform(), 20 * random.uniform()};
    EXPECT_NEAR(published_noise(p), published_noise(p + Vec3{16384, 0, 0}), 1e-9);
    EXPECT_NEAR(published_noise(p), published_noise(p - Vec3{16384, 0, 0}), 1e-9);
  }
}

// Independent impulses have 0.154; alternating signs in every cell take 8 % of the variance's odd part away.
TEST(PublishedNoise, IsSmoothAndBalanced) {
  double sum = 0, squares = 0;
  constexpr int n = 20000;
  Random random(1, 3);
  for (int k = 0; k < n; ++k) {
    const Vec3 p{100 * random.uniform() - 50, 100 * random.uniform() - 50, 100 * random.uniform() - 50};
    const double v = published_noise(p);
    sum += v, squares += v * v;
  }
  EXPECT_NEAR(sum / n, 0, 0.01);
  EXPECT_NEAR(std::sqrt(squares / n), 0.148, 0.005);
  for (double x = -3; x < 3; x += 0.5) {
    const Vec3 p{x, 0.31, -0.62};
    EXPECT_NEAR(published_noise(p - Vec3{1e-9, 0, 0}), published_noise(p + Vec3{1e-9, 0, 0}), 1e-7);
  }
  EXPECT_EQ(published_noise_grey({0.2, 0.3, 0.1}, 0), 0.5);
  EXPECT_GE(published_noise_grey({0.2, 0.3, 0.1}, 1e6), 0);
  EXPECT_LE(published_noise_grey({0.2, 0.3, 0.1}, 1e6), 1);
}

// One cell further along any axis the noise is another: 4000 pairs, correlation below 0.06 (z-test at 4 sigma).
TEST(PublishedNoise, HasNoDirection) {
  Random random(1, 4);
  for (const Vec3 step : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 1, 0}, Vec3{-1, 1, 0}}) {
    double products = 0, squares = 0;
    for (int k = 0; k < 4000; ++k) {
      const Vec3 p{100 * random.uniform() - 50, 100 * random.uniform() - 50, 100 * random.uniform() - 50};
      const double here = published_noise(p);
      products += here * published_noise(p + step), squares += here * here;
    }
    EXPECT_LT(std::abs(products / squares), 0.06) << step.x << ' ' << step.y << ' ' << step.z;
  }
}

}  // namespace
}  // namespace gonio::relief
