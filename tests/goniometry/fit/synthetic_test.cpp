// Fits of known truth: the numbers come back, intervals cover them, and what is not in the samples is refused.
#include "goniometry/fit/synthetic.h"

#include <gtest/gtest.h>

#include "goniometry/fit/fit.h"

namespace gonio {
namespace {

using goniometry::Fit;
using goniometry::FitOptions;
using goniometry::Fits;

TEST(Fit, FindsTheModelAndItsNumbers) {
  const surface::Model& model = *surface::find("coated-diffuse");
  const auto truth = tests::values_with(model, {{"albedo", {0.5, 0.3, 0.1}},
                                                {"sigma_rad", tests::grey(0)},
                                                {"f0", tests::grey(0.045)},
                                                {"alpha", tests::grey(0.15)}});
  auto samples = tests::directions_of(8, 60, 1);
  tests::measure(samples, model, truth, 0.02, 1e-3, 1, true);
  FitOptions options;
  options.models = {"diffuse", "coated-diffuse", "metal"};
  options.anisotropic = false;
  const Fits fits = goniometry::fit_surfaces(samples, options);
  ASSERT_LT(fits.chosen, fits.candidates.size());
  const Fit& chosen = fits.candidates[fits.chosen];
  EXPECT_EQ(chosen.model->info().id, "coated-diffuse") << chosen.verdict;
  EXPECT_EQ(chosen.variant, "");
  ASSERT_NE(chosen.number("alpha"), nullptr);
  // Five standard errors: a false alarm in 10^6.
  EXPECT_NEAR(chosen.number("alpha")->value, 0.15, 5 * chosen.number("alpha")->sigma);
  EXPECT_NEAR(chosen.number("albedo", 2)->value, 0.1, 5 * chosen.number("albedo", 2)->sigma);
  EXPECT_LT(chosen.held_out.scaled, 1.1);
}

}  // namespace
}  // namespace gonio
