// optics.defocus: a lens of finite aperture. Equation: render/camera_ray.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& optics_defocus() {
  static const Mechanism declaration{
      .id = "optics.defocus",
      .sentence = "The lens has an aperture, so that only one distance is sharp.",
      .typical = "0.5 to 5 px",
      .equation =
          "a point at depth z spreads over a disc of diameter 2 aperture_radius_m f |1/z - 1/focus_m| pixels, f the "
          "focal length in pixels",
      .source = "Cook, Porter & Carpenter 1984; Kolb, Mitchell & Hanrahan 1995, section 2 (thin lens)",
      .stage = "optics",
      .target = Target::camera,
      .domains = {"images"},
      .parameters = {{.name = "aperture_radius_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.1,
                      .start = 0.005,
                      .typical = 0.005,
                      .meaning = "radius of the entrance pupil: focal length over twice the f-number"},
                     {.name = "focus_m",
                      .unit = "m",
                      .neutral = 1,
                      .lower = 0.001,
                      .upper = 1000,
                      .start = 0.5,
                      .meaning = "distance along the axis of the plane that is sharp; without effect at radius 0"}},
      .conditions = {"image.edge-distance", "scene.depth"},
      .mistaken_for = {{.with = "light.finite-size",
                        .told_apart = "focus sweep; or move the light: a penumbra grows, blur stays"},
                       {.with = "surface.subsurface", .told_apart = "the profile of a point spot on the surface"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
