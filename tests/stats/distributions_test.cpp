// Distributions against tabulated values (R 4.2: pnorm, qnorm, pchisq, qchisq, pt, qt, pbinom) and against themselves.
#include "stats/distributions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gonio::stats {
namespace {

void near(double value, double expected, double relative = 1e-9) {
  EXPECT_NEAR(value, expected, relative * std::abs(expected));
}

TEST(Distributions, Normal) {
  near(normal_cdf(1.96), 0.9750021048517795);
  near(normal_upper(6), 9.865876450376946e-10);
  near(normal_upper(30), 4.906713927148187e-198, 1e-8);
  near(normal_quantile(0.975), 1.959963984540054);
  near(normal_quantile(0.001), -3.090232306167813);
  near(normal_upper_quantile(1e-30), 11.46402468916227, 1e-6);
  EXPECT_TRUE(std::isinf(normal_quantile(0)));
}

TEST(Distributions, ChiSquare) {
  near(chi2_upper(3.841458820694124, 1), 0.05);
  near(chi2_cdf(10, 10), 0.5595067149347875);
  near(chi2_quantile(0.95, 10), 18.30703805327515);
  near(chi2_quantile(0.5, 2), 2 * std::log(2.0));
  EXPECT_GT(chi2_upper(1000, 5), 0);
  EXPECT_LT(chi2_upper(1000, 5), 1e-200);
}

TEST(Distributions, Student) {
  near(student_quantile(0.975, 1), 12.70620473617471);
  near(student_quantile(0.975, 8), 2.306004135204166);
  near(student_cdf(2.0, 5), 0.9490302605850709);
  near(student_upper(2.0, 1e7), normal_upper(2.0), 1e-6);
}

TEST(Distributions, Binomial) {
  near(binomial_upper(3, 10, 0.2), 0.3222004736);
  EXPECT_EQ(binomial_upper(0, 10, 0.2), 1);
  EXPECT_EQ(binomial_upper(11, 10, 0.2), 0);
}

TEST(Distributions, QuantilesInvertDistributions) {
  for (const double p : {1e-6, 0.01, 0.3, 0.5, 0.9, 0.999999}) {
    EXPECT_NEAR(normal_cdf(normal_quantile(p)), p, 1e-12);
    for (const double degrees : {0.5, 1.0, 3.0, 27.0, 400.0}) {
      EXPECT_NEAR(chi2_cdf(chi2_quantile(p, degrees), degrees), p, 1e-11) << degrees;
      EXPECT_NEAR(student_cdf(student_quantile(p, degrees), degrees), p, 1e-11) << degrees;
    }
  }
}

TEST(Distributions, TailsAddUpToOne) {
  for (double x = 0.1; x < 60; x *= 1.7)
    for (const double a : {0.3, 1.0, 8.0, 50.0}) EXPECT_NEAR(gamma_lower(a, x) + gamma_upper(a, x), 1, 1e-13);
}

}  // namespace
}  // namespace gonio::stats
