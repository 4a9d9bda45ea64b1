// optics.lens-shading: mechanical vignetting, which goes when the lens is stopped down.
#include "scene/mechanisms/optics_lens_shading.h"

#include <algorithm>
#include <cmath>

#include "geom/angle.h"

namespace gonio::mechanism {

const Mechanism& optics_lens_shading() {
  static const Mechanism declaration{
      .id = "optics.lens-shading",
      .sentence =
          "The rim of the lens cuts the light towards the edge of the picture, the more, the wider the "
          "aperture is open.",
      .typical = "10 to 50 % at the corners, wide open; nothing two stops down",
      .equation =
          "pixel value *= A(d) / A(0), A the area common to the aperture (a disc of radius rim_f_number / N) and "
          "the rim (a disc of radius 1), d = shift r between their centres, r the distance from the picture's "
          "centre over half its width, N the f-number",
      .source =
          "Asada, Amano & Baba 1996, section 3 (vignetting of several apertures as overlapping discs); Goldman "
          "2010, section 2",
      .stage = "optics",
      .target = Target::scene,
      .domains = {"stacks"},
      .parameters = {{.name = "shift",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 2.5,
                      .start = 0.3,
                      .typical = 0.5,
                      .meaning = "by how many of its radii the rim lies beside the aperture, as seen from half a "
                                 "picture's width from the centre"},
                     {.name = "rim_f_number",
                      .unit = "1",
                      .neutral = 2,
                      .lower = 0.3,
                      .upper = 64,
                      .start = 2,
                      .typical = 2,
                      .meaning = "f-number at which the aperture is as wide as the rim; without effect at shift 0"}},
      .conditions = {"camera.image-radius", "image.aperture"},
      .mistaken_for = {{.with = "optics.vignetting", .told_apart = "the same pictures at another aperture"},
                       {.with = "scene.moved", .told_apart = "the same pictures again"}},
      .inputs = {{.name = "image_radius", .unit = "1", .lower = 0, .upper = 2.5},
                 {.name = "f_number", .unit = "1", .lower = 0.5, .upper = 64}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return v * equation::optics_lens_shading(p[1], p[0], at[1], at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism

namespace gonio::equation {

// Two circular segments, each of a sector less a triangle.
double shared_by_discs(double radius, double other_radius, double distance) {
  const double a = std::min(radius, other_radius), b = std::max(radius, other_radius), d = distance;
  if (d >= a + b) return 0;
  if (d <= b - a) return a * a;
  const double at_a = std::acos(std::clamp((d * d + a * a - b * b) / (2 * d * a), -1.0, 1.0)),
               at_b = std::acos(std::clamp((d * d + b * b - a * a) / (2 * d * b), -1.0, 1.0));
  return (a * a * (at_a - 0.5 * std::sin(2 * at_a)) + b * b * (at_b - 0.5 * std::sin(2 * at_b))) / pi;
}

double optics_lens_shading(double rim_f_number, double shift, double f_number, double radius) {
  const double aperture = rim_f_number / f_number, open = std::min(1.0, aperture * aperture);
  return shared_by_discs(aperture, 1, shift * radius) / open;
}

}  // namespace gonio::equation
