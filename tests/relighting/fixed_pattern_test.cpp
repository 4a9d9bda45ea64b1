// The pattern that a sensor lays over shaded, edged and noisy pictures, from several views
// (relighting/fixed_pattern.h).
#include "relighting/fixed_pattern.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace gonio::relighting {
namespace {

constexpr int side = 96;
constexpr double read_noise = 0.004;

double sensitivity(std::size_t place) {
  return Random(11, place).normal();
}

// Balls on a table, elsewhere in every view: curved shading and edges that do not stay with the pixels.
double radiance(int x, int y, std::size_t view) {
  const double shift = 17.0 * static_cast<double>(view);
  const double u = (std::fmod(x + shift, side) - 48) / 26, v = (y - 44 + 0.4 * shift) / 26, r2 = u * u + v * v;
  if (r2 < 1) return 0.2 + 0.7 * std::sqrt(1 - r2);
  return 0.5 / (1 + 1e-4 * ((x - 20) * (x - 20) + (y - 30) * (y - 30))) + 0.1;
}

// `size`: of the pattern; `noisier`: true noise over the noise that is stated.
Recordings recordings(double size, double noisier, std::size_t views) {
  Recordings r;
  for (std::size_t view = 0; view < views; ++view) {
    r.views.push_back({"c", camera::CameraModel(camera::Intrinsics{}, side, side), {}});
    Recording image;
    image.view = view;
    image.picture = io::Image(side, side, {"R", "G", "B"});
    image.counts.assign(side * side, 1);
    image.noise.read = read_noise;
    Random random(5 + view);
    for (int y = 0, i = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        for (int c = 0; c < 3; ++c, ++i) {
          const double v = radiance(x, y, view) * (1 + size * sensitivity(static_cast<std::size_t>(i)));
          image.picture.data[static_cast<std::size_t>(i)] =
              static_cast<float>(v + noisier * read_noise * random.normal());
        }
    image.mean = {0.4, 0.4, 0.4};
    r.images.push_back(image);
  }
  return r;
}

// Of the known pixels: n times the guess, over the guess squared. One where the guess is what can be expected of n.
double slope(const FixedPattern::OfView& view) {
  double product = 0, square = 0;
  for (std::size_t i = 0; i < view.normal.size(); ++i) {
    if (std::isnan(view.normal[i])) continue;
    product += sensitivity(i) * view.normal[i], square += view.normal[i] * view.normal[i];
  }
  return product / square;
}

double known(const FixedPattern::OfView& view) {
  double count = 0;
  for (const float n : view.normal) count += !std::isnan(n);
  return count / static_cast<double>(view.normal.size());
}

TEST(FixedPattern, HasItsSizeBesideCurvedShadingAndEdges) {
  for (const double size : {0.01, 0.04}) {
    const FixedPattern pattern = fixed_pattern(recordings(size, 1, 3));
    for (const FixedPattern::OfView& view : pattern.views) {
      EXPECT_NEAR(view.size / size, 1, 0.02);
      EXPECT_NEAR(slope(view), 1, 0.03) << size;  // of 21,000 values
      EXPECT_GT(known(view), 0.6);
    }
  }
}

// Noise that is stated at half of what it is would shrink what the term is fitted with, and its sigma with it.
TEST(FixedPattern, IsWhatViewsHaveInCommonWhateverNoiseIsStated) {
  for (const double noisier : {0.5, 2.0})
    for (const FixedPattern::OfView& view : fixed_pattern(recordings(0.02, noisier, 3)).views) {
      EXPECT_NEAR(view.size / 0.02, 1, 0.03) << noisier;
      EXPECT_NEAR(slope(view), 1, 0.03) << noisier;
    }
}

TEST(FixedPattern, OfASensorWithoutAnyIsNextToNothing) {
  for (const FixedPattern::OfView& view : fixed_pattern(recordings(0, 2, 3)).views) EXPECT_LT(view.size, 0.0015);
}

TEST(FixedPattern, OfOneViewIsUnknown) {
  const FixedPattern pattern = fixed_pattern(recordings(0.04, 1, 1));
  EXPECT_FALSE(pattern.views[0].any);
  EXPECT_EQ(known(pattern.views[0]), 0);
}

}  // namespace
}  // namespace gonio::relighting
