// tracks.perspective: depth that changes the scale within one picture. Equation: explain/tables/models/tracks.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& tracks_perspective() {
  static const Mechanism declaration{
      .id = "tracks.perspective",
      .sentence =
          "The object is near: its front is drawn larger than its back, which an orthographic camera leaves out.",
      .typical = "depth over distance: 1 to 30 %",
      .equation =
          "(u, v) - c -> ((u, v) - c) / (1 + inverse_focal_per_px s z), s the frame's scale in px/m, z the depth "
          "behind "
          "the frame's centre; s / f is one over the distance",
      .source = "Hartley & Zisserman 2004, section 6.3 (from affine to projective cameras)",
      .stage = "pose",
      .target = Target::camera,
      .domains = {"tables", "nrsfm"},
      .parameters = {{.name = "inverse_focal_per_px",
                      .unit = "1/px",
                      .lower = 0,
                      .upper = 0.02,
                      .typical = 1e-3,
                      .meaning = "one over the focal length; 0: orthographic"}},
      .conditions = {"tracks.depth", "camera.image-radius"},
      .mistaken_for = {{.with = "deformation", .told_apart = "film a rigid object of known shape with the same camera"},
                       {.with = "lens.radial", .told_apart = "film a flat board from the front and aslant"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
