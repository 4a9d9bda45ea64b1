// print.growth: the law that is stated, with other numbers; where a table is stated, the law beside it.
#include "print/mechanisms/print_growth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "explain/prints/print_term.h"
#include "manifest/sections/print.h"

namespace gonio::explain::prints::terms {
namespace {

equation::PrintGrowth told_of(const Sent& sent) {
  const print::Growth& growth = sent.printer.growth;
  if (growth.law()) return equation::print_growth_of(*growth.law());
  return {sent.printer.layer_m, 0, 0};
}

print::GrowthLaw law_of(const Sent& sent, std::span<const double> p) {
  equation::PrintGrowth told = told_of(sent);
  told.white_m *= 1 + p[0], told.threshold += p[1], told.curvature += p[2];
  return equation::print_growth(told);
}

void write(manifest::Print& print, const Sent& sent, std::span<const double> p, std::span<const double> covariance) {
  const auto numbers = [&](std::span<const double> at) {
    const print::GrowthLaw law = law_of(sent, at);
    return std::array<double, 3>{law.alpha_m, law.beta_m, law.gamma};
  };
  std::array<std::array<double, 3>, 3> slope{};  // [number][parameter]
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double> up(p.begin(), p.end()), down = up;
    const double step = 1e-3 * std::sqrt(std::max(1e-18, covariance[4 * k]));
    up[k] += step, down[k] -= step;
    const auto above = numbers(up), below = numbers(down);
    for (std::size_t n = 0; n < 3; ++n) slope[n][k] = (above[n] - below[n]) / (2 * step);
  }
  manifest::PrintGrowth entry;
  const auto law = numbers(p);
  entry.alpha_m = law[0], entry.beta_m = law[1], entry.gamma = std::clamp(law[2], -1.0, 1.0);
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) {
      double sum = 0;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) sum += slope[a][i] * covariance[3 * i + j] * slope[b][j];
      entry.covariance.push_back(sum);
    }
  entry.sigma = {{"alpha_m", {std::sqrt(entry.covariance[0])}},
                 {"beta_m", {std::sqrt(entry.covariance[4])}},
                 {"gamma", {std::sqrt(entry.covariance[8])}}};
  print.growth = std::move(entry);
}

}  // namespace

const Term& print_growth() {
  static const Term term{
      .mechanism = mechanism::print_growth,
      .bounds =
          [](const Sent& sent) {
            const equation::PrintGrowth told = told_of(sent);
            return std::vector<Bounds>{
                {0, -0.7, 2, 0.1},
                {0, -0.1 - told.threshold, 0.8 - told.threshold, 0.03},
                {0, equation::straightest - told.curvature, 60, std::max(0.5, 0.1 * told.curvature)}};
          },
      .set = [](Setting& setting, const Sent& sent, const Form&,
                std::span<const double> p) { setting.printer.growth = print::Growth(law_of(sent, p)); },
      // Greys that cease to cure are as many as a step is wide: they tell how high the law stands over the plane.
      .step = 0.5,
      .write = write};
  return term;
}

}  // namespace gonio::explain::prints::terms
