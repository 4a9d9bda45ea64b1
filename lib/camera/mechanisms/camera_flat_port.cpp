// camera.flat-port: light is refracted at a plane before the lens. Equation: camera/mechanisms/camera_flat_port.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& camera_flat_port() {
  static const Mechanism declaration{
      .id = "camera.flat-port",
      .sentence =
          "Between lens and object lies a flat interface (a window of a tank or housing, a surface of water): rays "
          "bend there, things look larger and nearer, the more so the further from the axis, and no lens can follow "
          "at two ranges.",
      .typical = "water 1.333: magnifies by a third, 1 to 30 px beyond what a focal length follows",
      .equation =
          "plane N . X = distance_m, N along (tan tilt_x_rad, tan tilt_y_rad, 1); beyond it sin theta_lens = index "
          "sin theta_beyond (Snell), and a point is seen where its ray leaves the plane",
      .source = "Treibitz, Schechner, Kunz & Singh, IEEE TPAMI 34(1), 2012 (flat refractive geometry); Snell's law",
      .stage = "optics",
      .target = Target::camera,
      .domains = {"boards"},
      .parameters = {{.name = "index",
                      .unit = "1",
                      .neutral = 1,
                      .lower = 0.6,
                      .upper = 2,
                      .start = 1.33,
                      .typical = 0.33,
                      .meaning = "refractive index beyond the interface over that around the camera"},
                     {.name = "distance_m",
                      .unit = "m",
                      .lower = 0,
                      .upper = 2,
                      .start = 0.03,
                      .typical = 0.05,
                      .meaning = "from the lens's centre to the interface, along its normal"},
                     {.name = "tilt_x_rad",
                      .unit = "rad",
                      .lower = -0.7,
                      .upper = 0.7,
                      .typical = 0.03,
                      .meaning = "turn of the normal from the axis towards the picture's right"},
                     {.name = "tilt_y_rad",
                      .unit = "rad",
                      .lower = -0.7,
                      .upper = 0.7,
                      .typical = 0.03,
                      .meaning = "turn of the normal from the axis towards the picture's bottom"}},
      .conditions = {"camera.image-radius", "camera.image-radius-over-distance", "camera.distance"},
      .mistaken_for = {{.with = "camera.focal-length",
                        .told_apart = "photograph the board outside of the water with the same focus"},
                       {.with = "lens.radial", .told_apart = "photograph the board at two ranges"},
                       {.with = "lens.non-central", .told_apart = "photograph the board at two ranges"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
