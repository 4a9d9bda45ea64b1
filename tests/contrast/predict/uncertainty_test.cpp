// Whether what `predict` states as sigma is what it says.
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "samples.h"
#include "stats/intervals.h"

namespace gonio::tests {
namespace {

using namespace contrast;

Specimen measured(double ridge_rad, double alpha, double sigma_ridge, double sigma_alpha) {
  return specimen_of("{\"model\": \"ridged\", \"ridge_rad\": " + std::to_string(ridge_rad) +
                     ", \"alpha_u\": 0.1, \"alpha_v\": " + std::to_string(alpha) + ", \"sigma\": {\"ridge_rad\": " +
                     std::to_string(sigma_ridge) + ", \"alpha_v\": " + std::to_string(sigma_alpha) + "}}");
}

// A sample whose ridge angle and roughness were measured with errors: 95 % intervals about the contrast that is
// predicted from the measurement hold the sample's own contrast in 95 % of 240 cases (exact interval of that share at
// 99.9 % holds 0.95, for three quantities).
TEST(ContrastUncertainty, IntervalsHoldTheTruth) {
  constexpr int cases = 240;
  const double sigma_ridge = 0.4 * degree, sigma_alpha = 0.006;
  Random random(17);
  std::array<int, 3> inside{};
  for (int i = 0; i < cases; ++i) {
    const double ridge = random.uniform(7, 12) * degree, alpha = random.uniform(0.08, 0.14);
    PredictOptions o{.draws = 200, .seed = static_cast<std::uint64_t>(i)};
    const auto of = [](const Prediction& p) {
      return std::array<Estimate, 3>{p.mean, p.combinations[4].difference, p.combinations[4].michelson};
    };
    const auto truth = of(predict(ridged(0.1, alpha, ridge / degree), o));
    const auto stated = of(predict(measured(ridge + sigma_ridge * random.normal(),
                                            alpha + sigma_alpha * random.normal(), sigma_ridge, sigma_alpha),
                                   o));
    for (std::size_t q = 0; q < 3; ++q)
      inside[q] += std::abs(truth[q].value - stated[q].value) < 1.96 * stated[q].sigma ? 1 : 0;
  }
  for (std::size_t q = 0; q < 3; ++q) {
    const stats::Interval share = stats::share_interval(inside[q], cases, 0.999);
    EXPECT_LT(share.lower, 0.95) << q << ": " << inside[q];
    EXPECT_GT(share.upper, 0.95) << q << ": " << inside[q];
  }
}

// At the ridge angle of greatest contrast the slope by it is zero: draws still see that any error lowers the contrast.
TEST(ContrastUncertainty, DoesNotVanishAtTheMaximum) {
  PredictOptions o;
  o.experiment.tilts_rad = {0};
  o.experiment.pairs_rad = {{0, pi / 2}};
  const Prediction p =
      predict(specimen_of(R"({"model": "ridged", "ridge_rad": 0.0872665, "alpha_u": 0.03, "alpha_v": 0.03,
                      "sigma": {"ridge_rad": 0.0087}})"),
              o);
  EXPECT_GT(p.mean.sigma, 0.05 * p.mean.value);
}

// A parameter that is varied errs alike in all settings, so that the mean over them errs as much as each, not less by
// the root of their number.
TEST(ContrastUncertainty, OneErrorForAllSettings) {
  PredictOptions o;
  o.experiment.tilts_rad = {0};
  o.varied = {{"rho_d", {0.2, 0.2001, 0.2002, 0.2003}}};
  const Prediction p = predict(specimen_of(R"({"model": "ridged", "ridge_rad": 0.1, "sigma": {"rho_d": 0.02}})"), o);
  EXPECT_NEAR(p.mean.sigma, means_over(p, "rho_d").mean[0].sigma, 0.01 * p.mean.sigma);
}

TEST(ContrastUncertainty, DrawsStayWithinBounds) {  // alpha may not be negative
  const Prediction p = predict(specimen_of(R"({"model": "ridged", "ridge_rad": 0.1, "alpha_u": 0.03,
                                               "sigma": {"alpha_u": 0.03}})"),
                               {});
  for (const Combination& c : p.combinations) EXPECT_TRUE(std::isfinite(c.difference.sigma));
  EXPECT_EQ(p.uncertain, std::vector<std::string>{"alpha_u 0.03"});
}

TEST(ContrastUncertainty, WithoutSigmasThereIsNone) {
  const Prediction p = predict(ridged(0.1, 0.1), {});
  EXPECT_EQ(p.draws, 0);
  EXPECT_EQ(p.mean.sigma, 0);
}

}  // namespace
}  // namespace gonio::tests
