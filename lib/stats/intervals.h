// Small statistics with honest widths: robust centre and spread, corrections for many looks, intervals for shares.
#pragma once
#include <span>

namespace gonio::stats {

struct Interval {
  double lower = 0, upper = 0;
};

double median(std::span<const double> values);              // NaN of an empty set
double quantile(std::span<const double> values, double p);  // linear between order statistics
// Standard deviation of normal numbers about zero over the median of their absolute values: 1 / quantile(3/4).
inline constexpr double sigma_of_median = 1.482602218505602;
// That times the median absolute deviation: the standard deviation of normal data, whatever a minority does.
double robust_sigma(std::span<const double> values);

double mean(std::span<const double> values);
double standard_error(std::span<const double> values);  // of the mean; infinity for fewer than two values

// Smallest of `looks` independent p-values, corrected: 1 - (1 - p)^looks (Sidak 1967), accurate for tiny p.
double sidak(double smallest_p, double looks);

// Share of successes with an exact interval (Clopper & Pearson 1934).
Interval share_interval(int successes, int trials, double confidence = 0.95);

// Power: the true effect, in standard deviations of its estimate, that a two-sided test at `level` finds with `power`.
double detectable_z(double level, double power);

}  // namespace gonio::stats
