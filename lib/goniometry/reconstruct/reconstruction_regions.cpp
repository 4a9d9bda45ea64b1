// Factors between regions, and of a class that was not seen.
#include "goniometry/reconstruct/reconstruction_regions.h"

#include <algorithm>
#include <cmath>

#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::goniometry {

std::size_t Widening::region_of(double u, double v) {
  const auto part = [](double x, std::size_t count) {
    return std::min(static_cast<std::size_t>(std::max(x, 0.0) * static_cast<double>(count)), count - 1);
  };
  return part(u, halves) * differences + part(v, differences);
}

double Widening::at(double u, double v) const {
  const auto place = [](double x, std::size_t count) {
    return std::clamp(x * static_cast<double>(count) - 0.5, 0.0, static_cast<double>(count - 1));
  };
  const double x = place(u, halves), y = place(v, differences);
  const auto h = std::min(static_cast<std::size_t>(x), halves - 2),
             d = std::min(static_cast<std::size_t>(y), differences - 2);
  const double a = x - static_cast<double>(h), b = y - static_cast<double>(d);
  const auto ln = [&](std::size_t i, std::size_t k) { return std::log(s[i * differences + k]); };
  return std::exp((1 - a) * ((1 - b) * ln(h, d) + b * ln(h, d + 1)) +
                  a * ((1 - b) * ln(h + 1, d) + b * ln(h + 1, d + 1)));
}

double Widening::typical() const {
  double sum = 0;
  for (const double factor : s) sum += std::log(factor);
  return std::exp(sum / static_cast<double>(regions));
}

double widening_of_next_class(std::span<const double> tau) {
  constexpr double share = 0.95, z = 1.959963984540054;
  constexpr int steps = 100;
  std::vector<double> logs(tau.size());
  std::ranges::transform(tau, logs.begin(), [](double t) { return std::log(t); });
  const double mean = stats::mean(logs), classes = static_cast<double>(tau.size());
  double squares = 0;
  for (const double x : logs) squares += (x - mean) * (x - mean);
  const double spread = std::sqrt(squares / (classes - 1) * (1 + 1 / classes));
  std::vector<double> next;
  for (int i = 0; i < steps; ++i)
    next.push_back(std::exp(mean + spread * stats::student_quantile((i + 0.5) / steps, classes - 1)));
  double low = std::exp(mean) / 64, high = 64 * next.back();
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    double covered = 0;
    for (const double t : next) covered += std::erf(z * middle / t / std::sqrt(2.0)) / steps;
    (covered < share ? low : high) = middle;
  }
  return high;
}

}  // namespace gonio::goniometry
