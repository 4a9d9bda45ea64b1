// Geometry and bookkeeping of the contrast experiment.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "base/random.h"
#include "samples.h"
#include "surface/microfacet.h"

namespace gonio::tests {
namespace {

using namespace contrast;

TEST(ContrastExperiment, TheLampStaysAtItsAngleFromTheCamera) {
  for (const LightPlane plane : {LightPlane::across, LightPlane::along})
    for (const double tilt : {-20.0, -10.0, 0.0, 10.0, 20.0})
      for (const double rotation : {0.0, 37.0, 90.0, 180.0}) {
        const View v = view_of({.plane = plane}, tilt * degree, rotation * degree);
        EXPECT_NEAR(std::acos(dot(v.wo, v.wi)), 10 * degree, 1e-12);
        EXPECT_NEAR(norm(v.wo), 1, 1e-12);
        EXPECT_NEAR(std::acos(v.wo.z), std::abs(tilt) * degree, 1e-9);
      }
}

// At zero tilt a facet of half the lamp's angle, unturned, is a mirror between lamp and camera: their half vector leans
// towards +y by it, whichever plane the lamp stands in.
TEST(ContrastExperiment, UnturnedFacetsLeanTowardsTheLamp) {
  for (const LightPlane plane : {LightPlane::across, LightPlane::along}) {
    const View v = view_of({.light_rad = 14 * degree, .plane = plane}, 0, 0);
    const Vec3 h = surface::half_vector(v.wo, v.wi);
    EXPECT_NEAR(h.x, 0, 1e-12);
    EXPECT_NEAR(h.y, std::sin(7 * degree), 1e-12);
  }
}

// Turning the sample is turning the structure in it.
TEST(ContrastExperiment, RotationTurnsTheRidges) {
  const Reflectance plain = ridged(0.1, 0.2).with({}), turned = ridged(0.1, 0.2, 5, 0.7).with({});
  for (const double tilt : {-15.0, 0.0, 10.0}) {
    const double expected = signal({}, turned, tilt * degree, 0);
    EXPECT_NEAR(signal({}, plain, tilt * degree, 0.7), expected, 1e-5 * expected);
  }
}

TEST(ContrastExperiment, AWhiteTileHasNoContrastAndSendsItsCosine) {
  const Specimen white = specimen_of(R"({"model": "diffuse", "albedo": 0.8})");
  const Reflectance f = white.with({});
  EXPECT_NEAR(signal({}, f, 0, 0), 0.8 / pi * std::cos(10 * degree), 1e-12);
  EXPECT_NEAR(signal({.veil = 0.1}, f, 0, 0), 0.9 / pi * std::cos(10 * degree), 1e-12);
  const Prediction p = predict(white, {});
  EXPECT_LT(p.mean.value, 1e-15);
}

// The mean over a disc of directions, against random ones: within four of their standard errors.
TEST(ContrastExperiment, SpreadLampAndLensAreMeansOverTheirDiscs) {
  const Reflectance f = ridged(0.04, 0.04).with({});
  Experiment e{.light_spread_rad = 3 * degree, .camera_spread_rad = 2 * degree};
  for (const double tilt : {0.0, 6.0}) {
    Random random(5);
    const View v = view_of(e, tilt * degree, 0);
    const auto about = [&random](Vec3 w, double half) {
      const Vec3 a = normalized(cross(w, {1, 0, 0})), b = cross(w, a);
      const double r = std::sin(half) * std::sqrt(random.uniform()), phi = 2 * pi * random.uniform();
      return normalized(w * std::sqrt(1 - r * r) + a * (r * std::cos(phi)) + b * (r * std::sin(phi)));
    };
    double sum = 0, squares = 0;
    constexpr int count = 40000;
    for (int i = 0; i < count; ++i) {
      const Vec3 wo = about(v.wo, e.camera_spread_rad), wi = about(v.wi, e.light_spread_rad);
      const double s = f(wo, wi) * wi.z;
      sum += s / count;
      squares += s * s / count;
    }
    const double error = std::sqrt((squares - sum * sum) / count);
    // Vogel's points are no more than a percent off for lobes as wide as the discs.
    EXPECT_NEAR(signal(e, f, tilt * degree, 0), sum, 4 * error + 0.01 * sum) << tilt;
    EXPECT_LT(signal(e, f, tilt * degree, 0), tilt == 0 ? 0.95 * signal({}, f, 0, 0) : 1e9);
  }
}

// Why the lamp stands across: along the plane of tilt, the tilts 0 and -light are mirror images of each other, and no
// model whose lobes follow the half vector can tell their means apart.
TEST(ContrastExperiment, AlongThePlaneOfTiltZeroIsNoSpecialTilt) {
  PredictOptions o{.varied = {ridge_angles()}};
  o.experiment.plane = LightPlane::along;
  for (const double alpha : {0.03, 0.05, 0.1, 0.2}) {
    const Means tilt = means_over(predict(ridged(alpha, alpha), o), "tilt");
    EXPECT_NEAR(tilt.mean[1].value, tilt.mean[2].value, 0.06 * tilt.mean[2].value) << alpha;
    EXPECT_NE(largest(tilt), 2u) << alpha;
  }
}

TEST(ContrastExperiment, MeansAreOfEveryCombinationThatSharesACondition) {
  const std::vector<double> values(4 * 5 * 3, 0);
  Signals signals{.value = values, .draws = {}};
  std::iota(signals.value.begin(), signals.value.end(), 1.0);
  for (double& v : signals.value) v = std::fmod(v * v * 7, 31);
  const Prediction p = assembled({}, {ridge_angles()}, signals);
  ASSERT_EQ(p.combinations.size(), 40u);
  for (const Means& m : p.means) {
    double total = 0;
    for (const Estimate& e : m.mean) total += e.value / static_cast<double>(m.mean.size());
    EXPECT_NEAR(total, p.mean.value, 1e-12) << m.over;
  }
  double at_ten = 0;
  for (const Combination& c : p.combinations)
    if (std::abs(c.varied[0] - 10 * degree) < 1e-9) at_ten += c.difference.value / 10;
  EXPECT_NEAR(means_over(p, "ridge_rad").mean[1].value, at_ten, 1e-12);
}

// Signals a, b, c with errors s each: |a - b| has sqrt(2) s, and the mean of |a - b| and |b - c| for a > b > c is
// (a - c) / 2, in which b, which they share, is gone: s / sqrt(2). Within 5 % of 20000 draws.
TEST(ContrastExperiment, ErrorsThatContrastsShareAreCountedOnce) {
  Experiment e;
  e.tilts_rad = {0};
  const Prediction p = assembled(e, {}, with_errors({3, 2, 1}, {0.01, 0.01, 0.01}, 20000, 1));
  EXPECT_NEAR(p.combinations[0].difference.sigma, std::sqrt(2) * 0.01, 0.0005);
  EXPECT_NEAR(p.mean.sigma, 0.01 / std::sqrt(2), 0.0004);
  EXPECT_NEAR(p.combinations[0].michelson.sigma, 2 * 0.01 * std::hypot(3, 2) / 25, 0.0002);
}

}  // namespace
}  // namespace gonio::tests
