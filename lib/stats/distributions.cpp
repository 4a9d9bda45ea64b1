// See distributions.h. Quantiles invert the distribution function by bracketed Newton steps: both directions agree.
#include "stats/distributions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stats/incomplete_beta.h"

namespace gonio::stats {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double tiny = 1e-300, precision = 1e-15;
constexpr int terms = 10000;

// exp(-x) x^a / Gamma(a), through logarithms.
double gamma_factor(double a, double x) { return std::exp(a * std::log(x) - x - std::lgamma(a)); }

// A&S 6.5.29: P(a, x) = x^a e^-x sum x^n / (a (a + 1) ... (a + n)) / Gamma(a); converges fast for x < a + 1.
double gamma_series(double a, double x) {
  double term = 1 / a, sum = term;
  for (int n = 1; n < terms && std::abs(term) > std::abs(sum) * precision; ++n) sum += term *= x / (a + n);
  return sum * gamma_factor(a, x);
}

// A&S 6.5.31 for Q(a, x), x >= a + 1.
double gamma_fraction(double a, double x) {
  double b = x + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
  for (int n = 1; n < terms; ++n) {
    const double an = -n * (n - a);
    b += 2;
    d = an * d + b;
    if (std::abs(d) < tiny) d = tiny;
    c = b + an / c;
    if (std::abs(c) < tiny) c = tiny;
    d = 1 / d;
    const double change = c * d;
    h *= change;
    if (std::abs(change - 1) < precision) break;
  }
  return h * gamma_factor(a, x);
}

// A&S 26.5.8, the continued fraction of the incomplete beta function.
double beta_fraction(double x, double a, double b) {
  double c = 1, d = 1 - (a + b) * x / (a + 1);
  d = 1 / (std::abs(d) < tiny ? tiny : d);
  double h = d;
  for (int m = 1; m < terms; ++m) {
    double change = 1;
    for (const double numerator : {m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                                   -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))}) {
      d = 1 + numerator * d;
      c = 1 + numerator / c;
      d = 1 / (std::abs(d) < tiny ? tiny : d);
      if (std::abs(c) < tiny) c = tiny;
      change = c * d;
      h *= change;
    }
    if (std::abs(change - 1) < precision) break;
  }
  return h;
}

// x in [lower, upper] with f(x) = target for an increasing f: bisection, which needs no derivative and cannot fail.
template <class Function>
double invert(const Function& f, double target, double lower, double upper) {
  for (int i = 0; i < 400 && upper - lower > 1e-15 * (std::abs(lower) + std::abs(upper)); ++i) {
    const double middle = 0.5 * (lower + upper);
    (f(middle) < target ? lower : upper) = middle;
  }
  return 0.5 * (lower + upper);
}

}  // namespace

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }
double normal_upper(double z) { return 0.5 * std::erfc(z / std::sqrt(2.0)); }

double normal_upper_quantile(double p) {
  if (!(p > 0)) return infinity;
  if (!(p < 1)) return -infinity;
  if (p > 0.5) return -normal_upper_quantile(1 - p);
  return invert([](double z) { return -std::log(normal_upper(z)); }, -std::log(p), 0, 38);
}
double normal_quantile(double p) { return p < 0.5 ? -normal_upper_quantile(p) : normal_upper_quantile(1 - p); }

double gamma_lower(double a, double x) {
  if (!(x > 0)) return 0;
  return x < a + 1 ? gamma_series(a, x) : 1 - gamma_fraction(a, x);
}
double gamma_upper(double a, double x) {
  if (!(x > 0)) return 1;
  return x < a + 1 ? 1 - gamma_series(a, x) : gamma_fraction(a, x);
}

double beta_regularised(double x, double a, double b) {
  if (!(x > 0)) return 0;
  if (!(x < 1)) return 1;
  const double factor =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1) / (a + b + 2)) return factor * beta_fraction(x, a, b) / a;
  return 1 - factor * beta_fraction(1 - x, b, a) / b;
}

double log_beta_regularised(double x, double y, double a, double b) {
  if (!(x > 0)) return -infinity;
  if (!(y > 0)) return 0;
  const double log_factor = std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log(y);
  if (x < (a + 1) / (a + b + 2)) return log_factor + std::log(beta_fraction(x, a, b) / a);
  return std::log1p(-std::exp(log_factor) * beta_fraction(y, b, a) / b);
}

double chi2_cdf(double x, double degrees) { return gamma_lower(degrees / 2, x / 2); }
double chi2_upper(double x, double degrees) { return gamma_upper(degrees / 2, x / 2); }
double chi2_quantile(double p, double degrees) {
  if (!(p > 0)) return 0;
  if (!(p < 1)) return infinity;
  double upper = std::max(1.0, degrees);
  while (chi2_cdf(upper, degrees) < p) upper *= 2;
  return invert([&](double x) { return chi2_cdf(x, degrees); }, p, 0, upper);
}

double student_upper(double t, double degrees) {
  const double tail = 0.5 * beta_regularised(degrees / (degrees + t * t), degrees / 2, 0.5);
  return t > 0 ? tail : 1 - tail;
}
double student_cdf(double t, double degrees) { return student_upper(-t, degrees); }
double student_quantile(double p, double degrees) {
  if (!(p > 0)) return -infinity;
  if (!(p < 1)) return infinity;
  if (p < 0.5) return -student_quantile(1 - p, degrees);
  double upper = 2;
  while (student_cdf(upper, degrees) < p) upper *= 2;
  return invert([&](double t) { return student_cdf(t, degrees); }, p, 0, upper);
}

double binomial_upper(int successes, int trials, double p) {
  if (successes <= 0) return 1;
  if (successes > trials) return 0;
  return beta_regularised(p, successes, trials - successes + 1);
}

}  // namespace gonio::stats
