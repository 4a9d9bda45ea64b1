// Halos by squares of growing size against sums over all pixels, and what their kernel is known for.
#include "render/halo.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "geom/vector.h"

namespace gonio::render {
namespace {

double kernel(double r2, double radius) {
  return std::pow(1 + r2 / (radius * radius), -1.5) / (2 * pi * radius * radius);
}

// Smooth with bright spots, as pictures are.
io::Image picture_of(int width, int height) {
  io::Image picture(width, height, {"R", "G"});
  Random random(3, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 2; ++c)
        picture.at(x, y, c) =
            static_cast<float>(1 + std::sin(0.2 * x + 0.1 * y * (c + 1)) + (random.uniform() < 0.01 ? 8 : 0));
  return picture;
}

TEST(Halo, IsTheSumOverAllPixels) {
  const io::Image picture = picture_of(90, 61);
  const std::vector<double> radii{1.0, 2.7, 9.0, 40.0};
  const Halo halo(picture, radii);
  Random random(4, 1);
  for (int n = 0; n < 40; ++n) {
    const int x = static_cast<int>(random.below(90)), y = static_cast<int>(random.below(61));
    const std::vector<double> found = halo.around(x, y);
    for (std::size_t r = 0; r < radii.size(); ++r)
      for (int c = 0; c < 2; ++c) {
        double sum = 0;
        for (int v = 0; v < 61; ++v)
          for (int u = 0; u < 90; ++u)
            if (u != x || v != y) sum += picture.at(u, v, c) * kernel((u - x) * (u - x) + (v - y) * (v - y), radii[r]);
        EXPECT_NEAR(found[2 * r + static_cast<std::size_t>(c)], sum, 0.02 * sum)
            << radii[r] << " at " << x << ", " << y;
      }
  }
}

// Far from the borders a white picture's halo is white, but for what lies beyond them: R / distance, about.
TEST(Halo, OfAWhitePictureIsWhite) {
  io::Image white(401, 401, {"Y"});
  for (float& v : white.data) v = 1;
  for (const double radius : {1.0, 1.5, 4.0}) {
    const double sum = Halo(white, {&radius, 1}).around(200, 200)[0] + Halo::own_share(radius);
    EXPECT_LT(sum, 1 + 4 * std::exp(-2 * pi * radius));
    EXPECT_NEAR(sum, 1, 1.2 * radius / 200);
  }
}

TEST(Halo, TakesWhatIsNotFiniteAsDark) {
  io::Image picture(3, 1, {"Y"});
  picture.data = {1, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()};
  const double radius = 2;
  EXPECT_NEAR(Halo(picture, {&radius, 1}).around(1, 0)[0], kernel(1, 2), 1e-12);
}

}  // namespace
}  // namespace gonio::render
