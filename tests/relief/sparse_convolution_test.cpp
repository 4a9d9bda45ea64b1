#include "relief/sparse_convolution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace gonio::relief {
namespace {

// Reckoned by hand for one impulse: the cell at the origin, its first impulse, seed 4.
//   3125 * 4 + 49 = 12549; 3125 * 12549 + 49 = 39215674 = 598 * 65536 + 25146; 3125 * 25146 + 49 = 78581299 =
//   1199 * 65536 + 3635 (x, y); 3125 * 3635 + 49 = 11359424 = 173 * 65536 + 21696 (z).
// There the noise is that height and what the other impulses of the eight cells add, written out.
TEST(PublishedNoise, ItsImpulsesLieWhereTheGeneratorSays) {
  const Vec3 place{25146 / 65536.0, 3635 / 65536.0, 21696 / 65536.0};
  const double height = -12549 / 65536.0, factor = 4 / (5 * std::cbrt(30.0));
  double others = 0;
  for (int q = 0; q < 8 * 30; ++q) {
    const std::int64_t cx = (q / 30 & 1) - 1 + (place.x >= 0.5), cy = (q / 30 >> 1 & 1) - 1 + (place.y >= 0.5),
                       cz = (q / 30 >> 2) - 1 + (place.z >= 0.5), j = q % 30 + 1;
    if (cx == 0 && cy == 0 && cz == 0 && j == 1) continue;
    std::int64_t t = 4 * (30 * (cx + 1000 * cy + 576 * cz) + j);
    double r[4];
    for (double& v : r) {
      t = ((3125 * t + 49) % 65536 + 65536) % 65536;
      v = static_cast<double>(t) / 65536;
    }
    const Vec3 d =
        Vec3{static_cast<double>(cx) + r[1], static_cast<double>(cy) + r[2], static_cast<double>(cz) + r[3]} - place;
    const double left = 1 - 4 * dot(d, d);
    if (left > 0) others += (j % 2 == 0 ? 1 : -1) * r[0] * left * left * left;
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

// Independent impulses would have relief/noise.h's standard deviation, 0.154; those of this generator, whose seeds are
// four apart, go together: 0.225, by these very points.
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
  EXPECT_NEAR(std::sqrt(squares / n), 0.225, 0.005);
  for (double x = -3; x < 3; x += 0.5) {
    const Vec3 p{x, 0.31, -0.62};
    EXPECT_NEAR(published_noise(p - Vec3{1e-9, 0, 0}), published_noise(p + Vec3{1e-9, 0, 0}), 1e-7);
  }
  EXPECT_EQ(published_noise_grey({0.2, 0.3, 0.1}, 0), 0.5);
  EXPECT_GE(published_noise_grey({0.2, 0.3, 0.1}, 1e6), 0);
  EXPECT_LE(published_noise_grey({0.2, 0.3, 0.1}, 1e6), 1);
}

}  // namespace
}  // namespace gonio::relief
