// What Luongo et al. 2017 (section 5) found with their model, found again with `ridged`; over which roughness it holds;
// and what else than burrs moves the best ridge angle. They do not state the roughness of their samples.
#include <gtest/gtest.h>

#include <cstdio>

#include "samples.h"

namespace gonio::tests {
namespace {

using namespace contrast;

Prediction experiment(double alpha_u, double alpha_v, Definition definition = Definition::difference,
                      double walls = 0) {
  PredictOptions o{.varied = {ridge_angles()}};
  o.experiment.definition = definition;
  return predict(ridged(alpha_u, alpha_v, 5, 0, walls), o);
}

// "Maximum contrast for zero tilting angle and decreasing contrast when the camera is tilted."
TEST(ContrastFindings, GreatestAtZeroTilt) {
  const Means tilt = means_over(experiment(0.05, 0.05), "tilt");
  EXPECT_EQ(tilt.label[largest(tilt)], "0");
  for (std::size_t i : {0u, 1u, 3u, 4u}) EXPECT_LT(tilt.mean[i].value, 0.2 * tilt.mean[2].value);
}

// "The contrast between the azimuthal angles 0 and 90 stronger than the contrast between 90 and 180."
TEST(ContrastFindings, FromZeroToNinetyItIsStrongerThanFromNinetyOn) {
  const Means pair = means_over(experiment(0.05, 0.05), "rotation");
  EXPECT_GT(pair.mean[0].value, 5 * pair.mean[1].value);
}

// "Our model predicts the highest contrast with a 5 degrees angle."
TEST(ContrastFindings, HighestAtFiveDegrees) {
  const Means ridge = means_over(experiment(0.05, 0.05), "ridge_rad");
  EXPECT_EQ(ridge.label[largest(ridge)], "5");
  EXPECT_GT(ridge.mean[0].value, 5 * ridge.mean[1].value);
}

// Over which roughness all three hold is printed; they do wherever alpha_u <= 0.06 and alpha_v <= 0.1, and not from
// 0.1 on in both.
TEST(ContrastFindings, HoldForNarrowLobes) {
  std::printf("alpha_u alpha_v: best tilt, best ridge angle, 0-90 over 90-180\n");
  for (const double alpha_u : {0.02, 0.04, 0.06, 0.08, 0.1, 0.15, 0.2})
    for (const double alpha_v : {0.02, 0.04, 0.06, 0.08, 0.1, 0.15, 0.2}) {
      const Prediction p = experiment(alpha_u, alpha_v);
      const Means tilt = means_over(p, "tilt"), ridge = means_over(p, "ridge_rad"), pair = means_over(p, "rotation");
      const double ratio = pair.mean[0].value / pair.mean[1].value;
      const std::string best_tilt = tilt.label[largest(tilt)], best_ridge = ridge.label[largest(ridge)];
      std::printf("%.2f %.2f: %4s %3s %8.3g\n", alpha_u, alpha_v, best_tilt.c_str(), best_ridge.c_str(), ratio);
      EXPECT_GT(ratio, 1) << alpha_u << " " << alpha_v;
      if (alpha_u <= 0.06 && alpha_v <= 0.1) {
        EXPECT_EQ(best_tilt, "0") << alpha_u << " " << alpha_v;
        EXPECT_EQ(best_ridge, "5") << alpha_u << " " << alpha_v;
      }
      if (alpha_u >= 0.1 && alpha_v >= 0.1) {
        EXPECT_NE(best_ridge, "5") << alpha_u << " " << alpha_v;
      }
    }
}

// The published model lets walls swallow what they meet. Walls that reflect like facets change no finding, at any of
// these roughnesses: they add where facets are dark.
TEST(ContrastFindings, StandWithWallsThatReflect) {
  for (const double alpha : {0.05, 0.08, 0.1}) {
    const Prediction without = experiment(alpha, alpha), with = experiment(alpha, alpha, Definition::difference, 1);
    for (const char* over : {"tilt", "ridge_rad"}) {
      const Means before = means_over(without, over), after = means_over(with, over);
      EXPECT_EQ(before.label[largest(before)], after.label[largest(after)]) << alpha << " " << over;
    }
    const Means pair = means_over(with, "rotation");
    EXPECT_GT(pair.mean[0].value, pair.mean[1].value) << alpha;
    EXPECT_GT(with.mean.value, without.mean.value) << alpha;
    EXPECT_LT(with.mean.value, 1.06 * without.mean.value) << alpha;
  }
}

// Michelson's contrast has none of them: for Gaussian slopes log(a / b) = 2 h tan(theta_r) / alpha^2 for both pairs,
// which grows with the ridge angle whatever the tilt.
TEST(ContrastFindings, AreOfTheDifferenceAndNotOfMichelson) {
  const Prediction p = experiment(0.1, 0.1, Definition::michelson);
  const Means ridge = means_over(p, "ridge_rad"), tilt = means_over(p, "tilt"), pair = means_over(p, "rotation");
  EXPECT_EQ(ridge.label[largest(ridge)], "20");
  EXPECT_NE(tilt.label[largest(tilt)], "0");
  EXPECT_NEAR(pair.mean[0].value / pair.mean[1].value, 1, 0.05);
}

}  // namespace
}  // namespace gonio::tests
