// camera.focal-length: a focal length other than stated. On boards the base model frees fx and fy, and this is asked of
// cameras that other views have calibrated ("held"). Equation: scene/edits/camera_focal_length.cpp,
// camera/corner_model.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& camera_focal_length() {
  static const Mechanism declaration{
      .id = "camera.focal-length",
      .sentence =
          "The focal length is not what the camera section says: everything is drawn larger or "
          "smaller about the principal point.",
      .typical = "0.1 to 5 %; a change of focus moves it by 1 %",
      .equation = "fx, fy times 1 + relative",
      .source = "Hartley & Zisserman 2004, section 6.1",
      .stage = "optics",
      .target = Target::camera,
      .domains = {"boards", "images", "clouds"},
      .parameters = {{.name = "relative",
                      .unit = "1",
                      .lower = -0.5,
                      .upper = 0.5,
                      .start = 0.01,
                      .typical = 0.01,
                      .meaning = "change of fx and fy over themselves"}},
      .conditions = {"camera.edge-shift-radial", "camera.image-radius"},
      .mistaken_for = {{.with = "camera.flat-port",
                        .told_apart = "photograph the board at two ranges, and outside of the water"},
                       {.with = "camera.pose", .told_apart = "photograph from two ranges"},
                       {.with = "geometry.scale",
                        .told_apart = "photograph the object from two ranges, or measure it with a caliper"},
                       {.with = "lens.radial", .told_apart = "fill the corners of the image"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
