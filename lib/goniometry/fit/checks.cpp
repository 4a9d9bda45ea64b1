// See checks.h.
#include "goniometry/fit/checks.h"

#include <algorithm>
#include <cmath>

namespace gonio::goniometry {

double greatest_albedo(const Fit& fit) {
  constexpr int inclinations = 8, draws = 512;
  const auto part = [](double x) { return x - std::floor(x); };
  double greatest = 0;
  for (const surface::Values& values : fit.triples)
    for (int k = 0; k < inclinations; ++k) {
      const double theta = (k + 0.5) / inclinations * (pi / 2), turn = 2.4 * k;
      const Vec3 wo{std::sin(theta) * std::cos(turn), std::sin(theta) * std::sin(turn), std::cos(theta)};
      Rgb sum;
      for (int i = 0; i < draws; ++i)  // three dimensions
        sum += fit.model
                   ->sample(values, wo, {part(0.5 + i * 0.8191725133961645), part(0.5 + i * 0.6710436067037893)},
                            part(0.5 + i * 0.5497004779019703))
                   .weight;
      greatest = std::max(greatest, max_component(sum) / draws);
    }
  return greatest;
}

double reciprocity_error(const Fit& fit, const Samples& samples) {
  double worst = 0;
  const std::size_t step = samples.rows() / 200 + 1;
  for (std::size_t r = 0; r < samples.rows(); r += step) {
    const Vec3 wo = samples.wo[r], wi = samples.wi[r];
    if (wo.z <= 0 || wi.z <= 0) continue;
    const Rgb one = fit.model->evaluate(fit.triples[0], wo, wi), other = fit.model->evaluate(fit.triples[0], wi, wo);
    for (int c = 0; c < 3; ++c) {
      const double both = one[c] + other[c];
      if (both > 0) worst = std::max(worst, 2 * std::abs(one[c] - other[c]) / both);
    }
  }
  return worst;
}

}  // namespace gonio::goniometry
