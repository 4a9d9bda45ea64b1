// Ridges as geometry against the model `ridged`, in the views of the contrast experiment.
#include "contrast/predict/brute_force.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "samples.h"
#include "surface/fresnel.h"

namespace gonio::tests {
namespace {

using namespace contrast;

// Without burrs each signal agrees within five of its standard errors (of 60; chance of any beyond, with 7 degrees of
// freedom each: 0.1, so that two may be) and 0.3 % of the largest, for what is reflected three times. Walls that
// swallow what they meet, as published, miss light: their rms is more than twice as large.
TEST(TracedContrast, CleanRidgesAreTheModels) {
  const Experiment e;
  const std::vector<double> angles = ridge_angles().values;
  const TracedRidges ridges{.shape = {.pitch_m = 100e-6}, .alpha_u = 0.08, .alpha_v = 0.08, .ridges = 1, .paths = 512};
  const TracedSignals traced = traced_signals(e, angles, ridges);
  int beyond = 0;
  double largest_signal = 0;
  for (const double s : traced.value) largest_signal = std::max(largest_signal, s);
  std::array<double, 2> square{};
  for (const int walls : {0, 1}) {
    const Specimen model = ridged(0.08, 0.08, 5, 0, walls);
    std::size_t i = 0;
    for (const double angle : angles) {
      const Reflectance f = model.with({{"ridge_rad", angle}});
      for (const double tilt : e.tilts_rad)
        for (const double rotation : rotations_of(e)) {
          const double off = std::abs(traced.value[i] - signal(e, f, tilt, rotation));
          square[walls] += off * off;
          beyond += walls == 1 && off > 5 * traced.sigma[i] + 0.003 * largest_signal ? 1 : 0;
          ++i;
        }
    }
  }
  EXPECT_LE(beyond, 2);
  EXPECT_GT(square[0], 4 * square[1]) << std::sqrt(square[0]) << " " << std::sqrt(square[1]);
  const Prediction traced_means = traced_prediction(e, angles, ridges);
  const Means& best = means_over(traced_means, "ridge_rad");
  EXPECT_EQ(best.label[largest(best)], "5");
}

// Burrs that cover a share of the plane take that share of the mirror's light away, and no more than a fifth beyond it.
TEST(TracedContrast, BurrsTakeWhatTheyCover) {
  TracedRidges clean{.shape = {.pitch_m = 100e-6}, .ridges = 2, .patches = 6, .paths = 1024};
  TracedRidges burrs = clean;
  burrs.shape.burr_share = 0.7;
  burrs.shape.burr_height_m = burrs.shape.burr_width_m = 30e-6;
  burrs.shape.burr_length_m = 60e-6;
  const double ridge = 5 * degree;
  const std::vector<View> mirror{view_of({}, 0, 0)};
  const Estimate before = traced_lobe(clean, ridge, mirror)[0], after = traced_lobe(burrs, ridge, mirror)[0],
                 covered = covered_share(burrs, ridge);
  EXPECT_GT(covered.value, 0.1);
  EXPECT_LT(covered.value, 0.35);
  const double left = after.value / before.value, error = std::hypot(after.sigma, before.sigma) / before.value;
  EXPECT_LT(left, 1 - covered.value + 5 * std::hypot(error, covered.sigma) + 0.05);
  EXPECT_GT(left, 1 - 1.2 * covered.value - 0.05 - 5 * std::hypot(error, covered.sigma));
}

// What explain enters into a manifest's mechanisms is predicted, and rendered by the same scene, as it was explained.
TEST(TracedContrast, MechanismsOfRidgesArePredicted) {
  manifest::Document d = document_of(R"({"model": "ridged", "ridge_rad": 0.17, "alpha_u": 0.1, "alpha_v": 0.1})");
  const Reflectance plain = Specimen(d, "s").with({}), walls = ridged(0.1, 0.1, 0.17 * 180 / pi, 0, 1).with({});
  d.mechanisms["surface.walls"].parameters = {{"walls", 1.0}};
  const Reflectance with_walls = Specimen(d, "s").with({});
  d.mechanisms.clear();
  d.mechanisms["surface.residue"].parameters = {{"residue_share", 0.3}, {"residue_alpha", 0.6}};
  const Reflectance covered = Specimen(d, "s").with({});
  const double lumps = surface::fresnel_dielectric(1.0, 1.5) * 1 / (pi * 0.6 * 0.6) / 4;  // D = 1 / (pi alpha^2)
  const Vec3 up{0, 0, 1}, aside = normalized(Vec3{0.1, -0.4, 1});
  EXPECT_NEAR(covered(up, up), 0.7 * plain(up, up) + 0.3 * lumps, 1e-12);
  EXPECT_NE(with_walls(up, aside), plain(up, aside));
  EXPECT_NEAR(with_walls(up, aside), walls(up, aside), 1e-9);
}

}  // namespace
}  // namespace gonio::tests
