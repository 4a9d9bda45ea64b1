// See march.h.
#include "glass/refine/march.h"

#include <algorithm>
#include <cmath>

namespace gonio::glass {
namespace {

// The part of the line within the grid's full cells.
bool clip(const SplineField& field, Vec3 origin, Vec3 direction, double& low, double& high) {
  for (int axis = 0; axis < 3; ++axis) {
    const double first = 1, last = field.nodes()[static_cast<std::size_t>(axis)] - 2.0;
    const double o = origin[axis], d = direction[axis];
    if (std::abs(d) < 1e-12) {
      if (o < first || o > last) return false;
      continue;
    }
    const double a = (first - o) / d, b = (last - o) / d;
    low = std::max(low, std::min(a, b)), high = std::min(high, std::max(a, b));
  }
  return low < high;
}

// The zero between two places of unlike sign: regula falsi with Illinois' rule (Dowell & Jarratt 1971).
double zero(const SplineField& field, Vec3 origin, Vec3 direction, double a, double fa, double b, double fb) {
  double t = a;
  for (int k = 0; k < 60 && std::abs(b - a) > 1e-12; ++k) {
    t = (a * fb - b * fa) / (fb - fa);
    const double f = field.value(origin + direction * t);
    if (std::abs(f) < 1e-12) break;
    if ((f > 0) == (fb > 0)) {
      b = t, fb = f, fa /= 2;
    } else {
      a = b, fa = fb, b = t, fb = f;
    }
  }
  return t;
}

// The maximum near `t`, by Newton's method on the slope along the line, within a step.
void climb(const SplineField& field, Vec3 origin, Vec3 direction, double reach, Passage& passage) {
  double t = passage.at;
  for (int k = 0; k < 8; ++k) {
    const SplineField::Jet jet = field.jet(origin + direction * t);
    const double first = dot(jet.slope, direction), second = dot(direction, jet.curve * direction);
    if (!(second < 0)) return;
    const double step = std::clamp(-first / second, -reach, reach);
    t += step;
    if (std::abs(t - passage.at) > 2 * reach) return;
    if (std::abs(step) < 1e-10) break;
  }
  const double f = field.value(origin + direction * t);
  if (f >= passage.greatest) passage.greatest = f, passage.at = t;
}

}  // namespace

Passage passage(const SplineField& field, Vec3 origin, Vec3 direction, double from) {
  Passage all;
  double low = from, high = 1e9;
  if (!clip(field, origin, direction, low, high)) return all;
  all.meets_grid = true;
  double t = low, f = field.value(origin + direction * t);
  all.greatest = f, all.at = t;
  while (t < high) {
    const double next = std::min(high, t + std::clamp(0.6 * std::abs(f), 0.25, 3.0));
    const double g = field.value(origin + direction * next);
    if ((f > 0) != (g > 0)) all.crossings.push_back({zero(field, origin, direction, t, f, next, g), g > 0});
    if (g > all.greatest) all.greatest = g, all.at = next;
    t = next, f = g;
  }
  climb(field, origin, direction, 0.5, all);
  return all;
}

}  // namespace gonio::glass
