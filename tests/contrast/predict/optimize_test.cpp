// The surface of greatest contrast: against arithmetic, against a grid, and what is said of bounds.
#include "contrast/predict/optimize.h"

#include <gtest/gtest.h>

#include <cmath>

#include "contrast/predict/simplex_search.h"
#include "samples.h"

namespace gonio::tests {
namespace {

using namespace contrast;

Experiment untilted(double light_degrees) {
  Experiment e{.light_rad = light_degrees * degree};
  e.tilts_rad = {0};
  e.pairs_rad = {{0, pi / 2}};
  return e;
}

// A narrow lobe: the facet that mirrors the lamp into the camera, half the lamp's angle.
TEST(ContrastOptimum, TheRidgeAngleIsHalfTheLamps) {
  for (const double light : {10.0, 14.0, 24.0}) {
    const Wish wish{.experiment = untilted(light), .bounds = {{"ridge_rad", 0.01, 0.5}}};
    const Optimum o = optimize(ridged(0.03, 0.03), wish);
    EXPECT_NEAR(o.numbers[0].value / degree, light / 2, 0.05) << light;
    EXPECT_EQ(o.numbers[0].at_bound, 0);
    EXPECT_LT(o.numbers[0].keeps_from, o.numbers[0].value);
    EXPECT_GT(o.numbers[0].keeps_to, o.numbers[0].value);
    EXPECT_NEAR(contrast_at(ridged(0.03, 0.03), wish, {o.numbers[0].keeps_to}), 0.95 * o.contrast, 1e-6 * o.contrast);
  }
}

// No point of a fine grid is better, neither in the mean over tilts nor for their least.
TEST(ContrastOptimum, IsNotBeatenByAGrid) {
  const Specimen surface = ridged(0.1, 0.1);
  for (const bool least : {false, true}) {
    Wish wish{.bounds = {{"ridge_rad", 0.02, 0.6}, {"alpha_u", 0.05, 0.4}, {"alpha_v", 0.05, 0.4}}, .least = least};
    wish.experiment.tilts_rad = {-10 * degree, 0, 10 * degree};
    wish.experiment.light_spread_rad = 0;
    const Optimum o = optimize(surface, wish);
    double best = 0;
    for (int i = 0; i <= 24; ++i)
      for (int j = 0; j <= 20; ++j)
        for (int k = 0; k <= 20; ++k)
          best = std::max(
              best, contrast_at(surface, wish, {0.02 + 0.58 * i / 24, 0.05 + 0.35 * j / 20, 0.05 + 0.35 * k / 20}));
    EXPECT_GE(o.contrast, best * (1 - 1e-9)) << least;
    EXPECT_LT(o.contrast, 1.3 * best) << least;  // and it is the same hill
  }
}

TEST(ContrastOptimum, SaysWhichBoundsHoldIt) {
  Wish wish{.experiment = untilted(10), .bounds = {{"ridge_rad", 0.15, 0.5}, {"alpha_u", 0.03, 0.2}}};
  const Optimum o = optimize(ridged(0.05, 0.05), wish);
  EXPECT_EQ(o.numbers[0].at_bound, -1);  // 5 degrees is out of reach
  EXPECT_EQ(o.numbers[0].value, 0.15);
  EXPECT_EQ(o.numbers[1].at_bound, -1);
  EXPECT_NE(optimum_sentence(o, wish).find("held by its lower bound"), std::string::npos);
  wish.bounds = {{"ridge_rad", 0.01, 0.5}};
  EXPECT_EQ(optimum_sentence(optimize(ridged(0.05, 0.05), wish), wish).find("held"), std::string::npos);
}

// sinc^2 of a slit, and Beckmann's exp(-x^2 / alpha^2) in the half vector's slope, are equally wide at half height.
TEST(ContrastOptimum, DiffractionIsAsWideAsASlits) {
  const double pitch = 50e-6, ridge = 0.2, lambda = 550e-9, width = pitch * std::cos(ridge);
  double half = 0;  // angle at which sinc^2 falls to one half
  for (double a = 0; a < 0.05; a += 1e-7) {
    const double x = pi * width * a / lambda;
    if (x > 0 && std::pow(std::sin(x) / x, 2) < 0.5) {
      half = a;
      break;
    }
  }
  const double alpha = diffraction_alpha(pitch, ridge, lambda);
  EXPECT_NEAR(std::exp(-std::pow(half / 2 / alpha, 2)), 0.5, 1e-3);
}

// The largest pitch that is allowed is the best; a pitch at which diffraction is as wide as the roughness loses.
TEST(ContrastOptimum, PitchEndsWhereItsBoundIs) {
  const Specimen surface = ridged(0.03, 0.03);
  Wish wish{.experiment = untilted(10), .bounds = {{"ridge_rad", 0.01, 0.5}, {pitch_name, 3e-6, 150e-6}}};
  const Optimum o = optimize(surface, wish);
  EXPECT_EQ(o.numbers[1].at_bound, 1);
  EXPECT_FALSE(o.parameters.contains(pitch_name));
  EXPECT_LT(contrast_at(surface, wish, {5 * degree, 5e-6}), 0.8 * o.contrast);
}

TEST(ContrastOptimum, SearchFindsPeaksInsideAndInCorners) {
  const Box box{{-1, 0, 2}, {3, 5, 9}};
  const auto inside = greatest(box, 500, [](const std::vector<double>& x) {
    return -std::pow(x[0] - 1.234, 2) - 3 * std::pow(x[1] - 4.2, 2) - std::pow(x[2] - 2.5 - x[0] * 0.1, 2);
  });
  EXPECT_NEAR(inside.at[0], 1.234, 1e-3);
  EXPECT_NEAR(inside.at[1], 4.2, 1e-3);
  EXPECT_NEAR(inside.at[2], 2.6234, 1e-3);
  const auto corner = greatest(box, 500, [](const std::vector<double>& x) { return x[0] - x[1] + x[2]; });
  EXPECT_NEAR(corner.value, 12, 1e-6);
}

}  // namespace
}  // namespace gonio::tests
