// Distribution functions and quantiles of the normal, chi-square, Student t and binomial laws, to about 1e-12 relative.
//
// Upper tails are computed as such, not as 1 - cdf, so that p-values of 1e-300 are still numbers.
// Abramowitz & Stegun 1964, sections 6.5 and 26.5: incomplete gamma by series (6.5.29) or continued fraction (6.5.31),
// incomplete beta by continued fraction (26.5.8), both evaluated with Lentz's algorithm (Thompson & Barnett 1986).
#pragma once

namespace gonio::stats {

double normal_cdf(double z);
double normal_upper(double z);           // P(Z > z)
double normal_quantile(double p);        // 0 < p < 1; infinities at the ends
double normal_upper_quantile(double p);  // z with P(Z > z) = p, exact for tiny p

double gamma_lower(double a, double x);                 // regularised P(a, x)
double gamma_upper(double a, double x);                 // regularised Q(a, x)
double beta_regularised(double x, double a, double b);  // I_x(a, b)

double chi2_cdf(double x, double degrees);
double chi2_upper(double x, double degrees);
double chi2_quantile(double p, double degrees);

double student_cdf(double t, double degrees);
double student_upper(double t, double degrees);
double student_quantile(double p, double degrees);

double binomial_upper(int successes, int trials, double p);  // P(X >= successes)

}  // namespace gonio::stats
