// The profile's cumulative share against the integral of the profile itself, and its limits.
#include "surface/diffusion_profile.h"

#include <gtest/gtest.h>

#include "geom/vector.h"

namespace gonio::surface {
namespace {

TEST(DiffusionProfile, ShareWithinIsTheIntegralOfTheProfile) {
  for (const double albedo : {0.2, 0.5, 0.9})
    for (const double path_m : {0.001, 0.005}) {
      const double s = diffusion_scale(albedo), end_m = 0.004;
      double sum = 0;
      const int n = 20000;
      for (int i = 0; i < n; ++i) {
        const double r = (i + 0.5) * end_m / n;
        const double profile =
            s * (std::exp(-s * r / path_m) + std::exp(-s * r / (3 * path_m))) / (8 * pi * path_m * r);
        sum += 2 * pi * r * profile * end_m / n;
      }
      EXPECT_NEAR(diffusion_within(end_m, path_m, albedo), sum, 1e-6);
    }
}

TEST(DiffusionProfile, NothingSpreadsWithoutAFreePath) {
  EXPECT_EQ(diffusion_within(0, 0, 0.5), 1);
  EXPECT_NEAR(diffusion_within(10, 0.001, 0.5), 1, 1e-12);
  EXPECT_LT(diffusion_within(0.001, 0.01, 0.5), diffusion_within(0.001, 0.001, 0.5));
}

}  // namespace
}  // namespace gonio::surface
