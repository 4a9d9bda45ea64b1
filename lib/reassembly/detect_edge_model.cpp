// Steps, ramps and a sphere's limb under Gaussian blur.
#include "reassembly/detect_edge_model.h"

#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::reassembly {

namespace {
const double inverse_root_two_pi = 1 / std::sqrt(2 * pi);
}

Blurred blurred_step(double t, double blur) {
  const double x = t / blur, bell = inverse_root_two_pi / blur * std::exp(-0.5 * x * x);
  return {0.5 * std::erfc(-x / std::sqrt(2.0)), bell, -x / blur * bell};
}

Blurred blurred_ramp(double t, double blur) {
  const Blurred step = blurred_step(t, blur);
  return {t * step.value + blur * blur * step.slope, step.value, step.slope};
}

BlurredLimb::BlurredLimb(double radius, double blur, double from, double to) : from_(from), step_(blur / 8) {
  // With tau = x^2 the integrand is smooth and even at the limb, and the midpoint rule is enough.
  constexpr int nodes = 28;
  constexpr double wide = 4.5;
  const int count = static_cast<int>((to - from) / step_) + 3;
  table_.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double t = from + i * step_;
    const double first = std::sqrt(std::max(0.0, t - wide * blur)), last = std::sqrt(std::max(0.0, t + wide * blur));
    Blurred sum;
    for (int j = 0; j < nodes; ++j) {
      const double x = first + (last - first) * (j + 0.5) / nodes, tau = x * x, v = (t - tau) / blur;
      const double limb = std::sqrt(std::max(0.0, tau * (2 * radius - tau))) / radius;
      const double weight = limb * 2 * x * (last - first) / nodes * inverse_root_two_pi / blur * std::exp(-0.5 * v * v);
      sum.value += weight;
      sum.slope -= weight * v / blur;
      sum.bend += weight * (v * v - 1) / (blur * blur);
    }
    table_[static_cast<std::size_t>(i)] = sum;
  }
}

Blurred BlurredLimb::at(double t) const {
  const double u = std::clamp((t - from_) / step_, 0.0, static_cast<double>(table_.size()) - 1.001);
  const std::size_t i = static_cast<std::size_t>(u);
  const double a = u - static_cast<double>(i), b = 1 - a;
  const Blurred &p = table_[i], &q = table_[i + 1];
  const auto hermite = [&](double p0, double d0, double p1, double d1) {  // cubic
    return b * b * (1 + 2 * a) * p0 + a * a * (1 + 2 * b) * p1 + a * b * step_ * (b * d0 - a * d1);
  };
  return {hermite(p.value, p.slope, q.value, q.slope), hermite(p.slope, p.bend, q.slope, q.bend),
          b * p.bend + a * q.bend};
}

}  // namespace gonio::reassembly
