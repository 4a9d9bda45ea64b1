// See tone_curve.h. Within a segment of length h in x = ln(reading), slopes p0 and p1 at its ends and t the distance
// from its beginning, ln(light) rises by p0 t + (p1 - p0) t^2 / (2 h); the inverse is the root of that quadratic.
#include "render/tone_curve.h"

#include <algorithm>
#include <cmath>

#include "render/mechanisms/sensor_non_linearity.h"

namespace gonio::render {
namespace {

constexpr std::size_t nodes = tone_nodes.size();

const std::array<double, nodes>& log_nodes() {
  static const std::array<double, nodes> all = [] {
    std::array<double, nodes> x{};
    for (std::size_t k = 0; k < nodes; ++k) x[k] = std::log(tone_nodes[k]);
    return x;
  }();
  return all;
}

}  // namespace

ToneSlopes slopes_of(double slope, const ToneBends& bends) {
  ToneSlopes p;
  p[tone_anchor] = slope;
  for (std::size_t k = tone_anchor; k > 0; --k) p[k - 1] = p[k] * std::exp(bends[k - 1]);
  for (std::size_t k = tone_anchor; k + 1 < nodes; ++k) p[k + 1] = p[k] * std::exp(bends[k]);
  return p;
}

ToneCurve::ToneCurve(const ToneSlopes& slopes) : slopes_(slopes), log_light_{}, linear_(slopes == linear_tone) {
  const std::array<double, nodes>& x = log_nodes();
  log_light_[nodes - 1] = 0;
  for (std::size_t k = nodes - 1; k > 0; --k)
    log_light_[k - 1] = log_light_[k] - 0.5 * (slopes_[k - 1] + slopes_[k]) * (x[k] - x[k - 1]);
}

double ToneCurve::log_light(double at) const {
  const std::array<double, nodes>& x = log_nodes();
  if (at <= x[0]) return log_light_[0] + slopes_[0] * (at - x[0]);
  if (at >= x[nodes - 1]) return slopes_[nodes - 1] * (at - x[nodes - 1]);
  const auto k = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin()) - 1;
  const double t = at - x[k], h = x[k + 1] - x[k];
  return log_light_[k] + t * (slopes_[k] + 0.5 * (slopes_[k + 1] - slopes_[k]) * t / h);
}

double ToneCurve::light(double reading) const {
  if (reading == 0 || linear()) return reading;
  return std::copysign(std::exp(log_light(std::log(std::abs(reading)))), reading);
}

double ToneCurve::reading(double light) const {
  if (light == 0 || linear()) return light;
  const std::array<double, nodes>& x = log_nodes();
  const double y = std::log(std::abs(light));
  double at;
  if (y <= log_light_[0]) {
    at = x[0] + (y - log_light_[0]) / slopes_[0];
  } else if (y >= 0) {
    at = x[nodes - 1] + y / slopes_[nodes - 1];
  } else {
    const auto k =
        static_cast<std::size_t>(std::upper_bound(log_light_.begin(), log_light_.end() - 1, y) - log_light_.begin()) -
        1;
    const double h = x[k + 1] - x[k], rise = y - log_light_[k], p = slopes_[k], bend = (slopes_[k + 1] - p) / h;
    at = x[k] + 2 * rise / (p + std::sqrt(std::max(0.0, p * p + 2 * bend * rise)));
  }
  return std::copysign(std::exp(at), light);
}

double Response::operator()(double light) const {
  double v = light;
  if (quadratic != 0) v = equation::sensor_quadratic(v, quadratic, reference);
  if (gamma != 1) v = equation::sensor_power_law(v, gamma, reference, toe);
  if (shoulder != 0) v = equation::sensor_shoulder(v, shoulder, reference);
  if (!curve.linear()) v = reference * curve.reading(v / reference);
  return v;
}

double Response::light(double reading) const {
  double v = reading;
  if (!curve.linear()) v = reference * curve.light(v / reference);
  if (shoulder != 0) v = equation::sensor_shoulder_undone(v, shoulder, reference);
  if (gamma != 1) v = equation::sensor_power_law(v, 1 / gamma, reference, toe);
  // q u^2 + u = v with u = light / reference: u = 2 v / (1 + sqrt(1 + 4 q v)).
  if (quadratic != 0) v = 2 * v / (1 + std::sqrt(std::max(0.0, 1 + 4 * quadratic * v / reference)));
  return v;
}

}  // namespace gonio::render
