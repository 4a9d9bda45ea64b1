// See plausible.h.
#include "goniometry/fit/plausible.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "goniometry/outputs.h"
#include "surface/interface_albedo.h"

namespace gonio::goniometry {
namespace {

// A reflectance at the normal and its slopes by the fitted numbers `by`.
struct Reflectance {
  double value = 0;
  std::array<std::size_t, 2> by{};
  std::array<double, 2> slope{};
};

std::size_t place_of(const Fit& fit, const std::string& name, std::size_t band) {
  const auto found = std::ranges::find_if(fit.numbers, [&](const auto& n) { return n.name == name && n.band == band; });
  return static_cast<std::size_t>(found - fit.numbers.begin());
}

// With s = 1 + eta^2 + k^2: R = (s - 2 eta) / (s + 2 eta), dR = 4 (2 eta (eta deta + k dk) - s deta) / (s + 2 eta)^2.
Reflectance of_index(double eta, double k) {
  const double s = 1 + eta * eta + k * k, below = (s + 2 * eta) * (s + 2 * eta);
  return {(s - 2 * eta) / (s + 2 * eta), {}, {4 * (2 * eta * eta - s) / below, 8 * eta * k / below}};
}

Reflectance at_normal(const Fit& fit, std::size_t band) {
  const std::size_t none = fit.numbers.size(), f0 = place_of(fit, "f0", band);
  if (f0 != none) return {fit.numbers[f0].value, {f0, f0}, {1, 0}};
  const std::size_t eta = place_of(fit, "eta", band), k = place_of(fit, "k", band);
  if (eta == none || k == none) return {1, {}, {}};
  Reflectance r = of_index(fit.numbers[eta].value, fit.numbers[k].value);
  r.by = {eta, k};
  return r;
}

// NaN where nothing says.
double sigma_of(const Fit& fit, const Reflectance& r) {
  const std::size_t n = fit.numbers.size();
  if (fit.covariance.size() != n * n) return std::nan("");
  double variance = 0;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) variance += r.slope[i] * r.slope[j] * fit.covariance[r.by[i] * n + r.by[j]];
  return std::sqrt(variance);
}

}  // namespace

bool worse_than_a_constant(const Fit& fit, const Samples& samples) {
  constexpr double margin = 1.1;
  double sum = 0, squares = 0, count = 0;
  for (std::size_t r = 0; r < samples.rows(); ++r)
    for (std::size_t b = 0; b < samples.bands(); ++b) {
      const double f = samples.f[r * samples.bands() + b];
      if (!std::isfinite(f)) continue;
      const double v = compared(f, samples.wi[r], samples.wo[r]);
      sum += v, squares += v * v, ++count;
    }
  if (count < 2) return false;
  const double about_mean = std::sqrt(std::max(0.0, squares / count - (sum / count) * (sum / count)));
  return fit.fitted.log1p > margin * about_mean + 1e-6;
}

std::string brighter_than_possible(const Fit& fit) {
  for (const auto& info : fit.model->info().parameters) {
    if (!info.rgb || info.upper != 1) continue;
    std::size_t there = 0, all = 0;
    for (const FittedNumber& n : fit.numbers)
      if (n.name == info.name) ++all, there += n.at == FittedNumber::At::upper;
    if (there > 0)
      return info.name + " is 1 in " + std::to_string(there) + " of " + std::to_string(all) +
             (all == 1 ? " band" : " bands") + ": the samples are brighter than a surface that returns all light";
  }
  return {};
}

std::string unlike_metals(const Fit& fit) {
  const std::string& id = fit.model->info().id;
  if (!id.ends_with("metal") && !id.ends_with("conductor")) return {};
  Reflectance most;
  double reach = -1;
  for (const FittedNumber& number : fit.numbers) {
    if (number.band == whole_sample) continue;
    const Reflectance r = at_normal(fit, number.band);
    const double sigma = sigma_of(fit, r), upper = r.value + (std::isfinite(sigma) ? 2 * sigma : 0);
    if (upper > reach) most = r, reach = upper;
  }
  if (reach < 0 || reach > surface::max_dielectric_f0) return {};
  const double root = std::sqrt(most.value);
  return format("it reflects %.1f %% at the normal, which does not tell a metal from a dielectric of index %.2f",
                100 * most.value, (1 + root) / (1 - root));
}

}  // namespace gonio::goniometry
