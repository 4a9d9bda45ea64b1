// From pictures of actual ridges back to their angle and azimuth: the mesh is path traced, recorded with noise, reduced
// and fitted with the analytic model, of a resin and of a metal, whose walls send on as much light as its facets. The
// full study is scripts/proofs/brdf-ridges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "data.h"
#include "goniometry/fit/fit.h"
#include "ridge_plate.h"

namespace gonio::goniometry {
namespace {

void expect_found(const tests::RidgePlate& plate, std::uint64_t seed) {
  const tests::ScratchFolder folder;
  manifest::Document d = tests::ridge_recording(plate, {}, folder.path());
  tests::record(d, tests::render_all(d, 4), folder.path(), seed);
  const Reduced reduced = reduce(d);
  EXPECT_GE(reduced.samples.rows(), 135u) << reduced.dropped.front().reason;
  const Fits fits =
      fit_surfaces(reduced.samples, {.models = {"ridged"}, .lobes = 1, .random_starts = 0, .folds = 0, .check = false});
  ASSERT_FALSE(fits.candidates.empty());
  const Fit& fit = fits.candidates.front();
  const FittedNumber* angle = fit.number("ridge_rad");
  const FittedNumber* azimuth = fit.number("azimuth_rad");
  ASSERT_TRUE(angle && azimuth);
  std::printf("ridge %.3f +- %.3f, azimuth %.3f +- %.3f deg, walls %.3f, model error %.4f\n", angle->value / degree,
              angle->sigma / degree, azimuth->value / degree, azimuth->sigma / degree, fit.number("walls")->value,
              fit.model_error);
  EXPECT_LT(angle->sigma / degree, 0.1);
  EXPECT_LT(azimuth->sigma / degree, 0.3);
  EXPECT_NEAR(angle->value / degree, plate.ridge_rad / degree, 0.5);
  EXPECT_NEAR(azimuth->value / degree, plate.azimuth_rad / degree, 1);
  EXPECT_LE(angle->low, plate.ridge_rad);
  EXPECT_GE(angle->high, plate.ridge_rad);
  EXPECT_LE(azimuth->low, plate.azimuth_rad);
  EXPECT_GE(azimuth->high, plate.azimuth_rad);
}

TEST(Ridges, AngleAndAzimuthComeBackFromPicturesOfAResin) {
  expect_found({}, 1);
}

TEST(Ridges, AngleAndAzimuthComeBackFromPicturesOfAMetal) {
  expect_found({.ridge_rad = 15 * degree, .azimuth_rad = -55 * degree, .eta = {0.6, 1.0, 1.4}, .k = {3.4, 2.6, 2.0}},
               3);
}

// Without its walls the analytic model is, where they send nothing, what the mesh does, to a percent in the median
// of the brightest third of the samples.
TEST(Ridges, BrightSamplesAreTheAnalyticModels) {
  const tests::RidgePlate plate;
  const tests::ScratchFolder folder;
  manifest::Document d = tests::ridge_recording(plate, {.light_phis_rad = {pi / 2}, .cameras = 20}, folder.path());
  tests::record(d, tests::render_all(d, 4), folder.path(), 2);
  const Samples samples = reduce(d).samples;
  const surface::Model& model = *surface::find("ridged");
  const surface::Values values = surface::values_of(model,
                                                    {{"ridge_rad", plate.ridge_rad},
                                                     {"azimuth_rad", plate.azimuth_rad},
                                                     {"alpha_u", plate.alpha},
                                                     {"alpha_v", plate.alpha},
                                                     {"eta", plate.eta},
                                                     {"k", plate.k}},
                                                    "");
  std::vector<std::pair<double, double>> bright;  // f, its relative deviation
  for (std::size_t r = 0; r < samples.rows(); ++r) {
    const double f = samples.f[3 * r], expected = model.evaluate(values, samples.wo[r], samples.wi[r]).x;
    bright.push_back({-f, std::abs(f / expected - 1)});
  }
  std::ranges::sort(bright);
  std::vector<double> off;
  for (std::size_t i = 0; i < bright.size() / 3; ++i) off.push_back(bright[i].second);
  std::ranges::nth_element(off, off.begin() + off.size() / 2);
  EXPECT_LT(off[off.size() / 2], 0.01);
}

}  // namespace
}  // namespace gonio::goniometry
