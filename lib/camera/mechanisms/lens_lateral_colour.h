// How a lens magnifies one colour against green: lens.lateral-colour. Normalised coordinates.
#pragma once
#include <cstddef>
#include <span>

#include "camera/intrinsics.h"
#include "geom/vector.h"

namespace gonio::equation {

// Factor on (x', y') at r'^2.
inline double lens_lateral_colour(double linear, double cubic, double r2) {
  return 1 + linear + cubic * r2;
}

// The place in green of what the colour shows at `coloured`; by Newton's method on the radius.
inline Vec2 lens_lateral_colour_green(double linear, double cubic, Vec2 coloured) {
  const double radius = norm(coloured);
  double r = radius;
  for (int i = 0; i < 20 && radius > 0; ++i) {
    const double step = (r * lens_lateral_colour(linear, cubic, r * r) - radius) / (1 + linear + 3 * cubic * r * r);
    r -= step;
    if (!(step > 1e-14 || step < -1e-14)) break;
  }
  return radius > 0 ? coloured * (r / radius) : coloured;
}

// The pixel in green of what channel 0 (red), 1 or 2 (blue) shows at `pixel`. `p`: the mechanism's parameters.
inline Vec2 lens_lateral_colour_pixel(const camera::Intrinsics& lens, std::span<const double> p, Vec2 pixel,
                                      std::size_t channel) {
  if (channel == 1) return pixel;
  const Vec2 at{(pixel.x - lens.cx_px) / lens.fx_px, (pixel.y - lens.cy_px) / lens.fy_px};
  const Vec2 green = lens_lateral_colour_green(p[channel], p[channel + 1], at);
  return {lens.cx_px + lens.fx_px * green.x, lens.cy_px + lens.fy_px * green.y};
}

}  // namespace gonio::equation
