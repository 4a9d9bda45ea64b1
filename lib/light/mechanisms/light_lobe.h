// light.lobe: how a lamp's intensity falls with the angle from its axis, and the forms in which that is asked.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& light_lobe();

// Places of the parameters.
enum LobeNumber : std::size_t { lobe_exponent, lobe_outer, lobe_inner, lobe_tilt_x, lobe_tilt_y, lobe_numbers };

// Which numbers are free together, the plainest first: a lamp that fades, one with a cone; one that faces elsewhere
// than to the centre and fades about there; one that has a cone besides, as a spot has whose lens makes it fade.
inline constexpr std::array<LobeNumber, 1> fading_lobe = {lobe_exponent};
inline constexpr std::array<LobeNumber, 2> shaded_lobe = {lobe_outer, lobe_inner};
inline constexpr std::array<LobeNumber, 3> aimed_fade = {lobe_exponent, lobe_tilt_x, lobe_tilt_y};
inline constexpr std::array<LobeNumber, 5> aimed_lobe = {lobe_exponent, lobe_outer, lobe_inner, lobe_tilt_x,
                                                         lobe_tilt_y};
}  // namespace gonio::mechanism

namespace gonio::equation {

// Smooth edge of a cone: 1 within inner_share outer_rad, 0 beyond outer_rad; t linear in the cosine between.
inline double cone_edge(double cosine, double outer_rad, double inner_share) {
  const double outer = std::cos(outer_rad), inner = std::cos(inner_share * outer_rad);
  if (cosine >= inner) return 1;
  if (cosine <= outer) return 0;
  const double t = (cosine - outer) / (inner - outer);
  return t * t * (3 - 2 * t);
}

// Intensity over that on the axis, at `cosine` of the angle from it: p = exponent, outer_rad, inner_share. A lamp
// without a cone and without an exponent shines all round.
inline double light_lobe(double cosine, std::span<const double> p) {
  const double exponent = p[0], outer_rad = p[1];
  double factor = 1;
  if (exponent != 0) factor = std::pow(std::max(0.0, cosine), exponent);
  if (outer_rad < std::numbers::pi) factor *= cone_edge(cosine, outer_rad, p[2]);
  return factor;
}

}  // namespace gonio::equation
