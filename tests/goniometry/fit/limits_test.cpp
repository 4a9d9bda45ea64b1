// What directions cannot tell is not told: lobes narrower than the sampling are refused, wider ones are not.
#include "goniometry/fit/limits.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "goniometry/fit/fit.h"
#include "goniometry/fit/synthetic.h"

namespace gonio {
namespace {

using goniometry::FitOptions;
using goniometry::Fits;

// Scans in the plane of incidence in steps, from 45 degrees; the mirror direction lies between two steps where
// `between`.
goniometry::Samples scan(double step_deg, bool between) {
  goniometry::Samples s;
  s.name = "scan";
  s.band_name = {""};
  const double k = pi / 180, theta = 45 + (between ? step_deg / 2 : 0);
  for (double to = -75; to <= 75; to += step_deg) {
    s.wi.push_back(tests::direction(theta * k, 0));
    s.wo.push_back(tests::direction(to * k, pi));
    s.series.push_back(0);
  }
  return s;
}

goniometry::Samples measured(goniometry::Samples s, const char* id, double alpha, double f0) {
  const surface::Model& model = *surface::find(id);
  const auto truth = tests::values_with(model, {{"albedo", tests::grey(0.3)},
                                                {"sigma_rad", tests::grey(0)},
                                                {"f0", tests::grey(f0)},
                                                {"alpha", tests::grey(alpha)}});
  tests::measure(s, model, truth, 0.01, 1e-4, 5, true);
  return s;
}

TEST(LeastAlpha, FollowsTheStepsOfTheHalfVector) {
  // Steps of 4 degrees are steps of 2 in theta_h: 0.035 rad. On the peak: the flank needs a / 2 < 0.035 < 3 a / 2.
  EXPECT_NEAR(goniometry::least_alpha(scan(4, false)), 0.035 / 1.5, 0.001);
  // Beside it by a quarter of a step: the peak needs 0.0175 < a / 2.
  EXPECT_NEAR(goniometry::least_alpha(scan(4, true)), 0.035, 0.002);
  EXPECT_LT(goniometry::least_alpha(scan(1, false)), goniometry::least_alpha(scan(4, false)) / 3);
  EXPECT_FALSE(goniometry::turns_about_normal(scan(4, false)));
  EXPECT_TRUE(goniometry::turns_about_normal(tests::directions_of(3, 40, 1)));
}

TEST(LeastAlpha, IsOneWhereOneDirectionIsAll) {
  goniometry::Samples s = scan(1, false);
  s.wi.resize(1), s.wo.resize(1);
  EXPECT_EQ(goniometry::least_alpha(s), 1);
}

TEST(Fit, RefusesALobeNarrowerThanTheSampling) {
  FitOptions options;
  options.models = {"metal", "diffuse"};
  const Fits coarse = goniometry::fit_surfaces(measured(scan(6, true), "metal", 0.008, 0.6), options);
  EXPECT_GT(coarse.least_alpha, 0.04);
  const auto refused = std::ranges::find_if(coarse.refusals, [](const auto& r) { return r.model == "metal"; });
  ASSERT_NE(refused, coarse.refusals.end());
  EXPECT_NE(refused->reason.find("cannot be told from these angles"), std::string::npos) << refused->reason;
  for (const auto& fit : coarse.candidates) EXPECT_NE(fit.model->info().id, "metal");

  const Fits fine = goniometry::fit_surfaces(measured(scan(0.5, false), "metal", 0.008, 0.6), options);
  ASSERT_LT(fine.chosen, fine.candidates.size());
  const auto* alpha = fine.candidates[fine.chosen].number("alpha");
  ASSERT_NE(alpha, nullptr) << fine.candidates[fine.chosen].verdict;
  EXPECT_NEAR(alpha->value, 0.008, 5 * alpha->sigma);
  EXPECT_LT(alpha->sigma, 0.001);
}

TEST(Fit, SaysWhenABoundIsHit) {
  auto s = tests::directions_of(5, 60, 3);
  const surface::Model& model = *surface::find("diffuse");
  tests::measure(s, model, tests::values_with(model, {{"albedo", {0.5, 0.4, 0.3}}, {"sigma_rad", tests::grey(0)}}),
                 0.02, 1e-4, 3, true);
  FitOptions options;
  options.models = {"diffuse", "coated-diffuse"};
  options.anisotropic = false;
  const Fits fits = goniometry::fit_surfaces(s, options);
  ASSERT_LT(fits.chosen, fits.candidates.size());
  EXPECT_EQ(fits.candidates[fits.chosen].model->info().id, "diffuse") << fits.candidates[fits.chosen].verdict;
  bool pressed = false;
  for (const auto& fit : fits.candidates)
    for (const auto& n : fit.numbers) {
      if (n.at == goniometry::FittedNumber::At::inside) continue;
      pressed = true;
      EXPECT_TRUE(std::isnan(n.sigma));
      EXPECT_LE(n.low, n.value);
      EXPECT_GE(n.high, n.value);
      EXPECT_NE(fit.verdict.find("at a bound"), std::string::npos) << fit.verdict;
    }
  EXPECT_TRUE(pressed);
}

TEST(Fit, RefusesWhatItCannotUse) {
  goniometry::Samples none;
  none.name = "empty.csv";
  EXPECT_THROW(goniometry::fit_surfaces(none), Error);
  auto s = measured(scan(4, false), "coated-diffuse", 0.2, 0.04);
  FitOptions options;
  options.models = {"velvet"};
  EXPECT_THROW(goniometry::fit_surfaces(s, options), Error);
  options.models = {"diffuse"};
  options.scale = goniometry::Scale::noise;
  s.sigma.clear();
  EXPECT_THROW(goniometry::fit_surfaces(s, options), Error);
}

}  // namespace
}  // namespace gonio
