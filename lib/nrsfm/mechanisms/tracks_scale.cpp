// tracks.scale: scales that differ from frame to frame. Equation: explain/nrsfm/deforming_model.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& tracks_scale() {
  static const Mechanism declaration{
      .id = "tracks.scale",
      .sentence =
          "The object is drawn larger in some frames than in others, as it comes nearer or the lens zooms, which a "
          "camera with one scale for all frames leaves out.",
      .typical = "1 to 50 %",
      .equation = "(u, v) = exp(log_scale) (q_x, q_y) + t of every frame; the logarithms' mean is 0",
      .source = "Torresani, Hertzmann & Bregler, PAMI 30, 2008, equation 1 (c_t)",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"nrsfm"},
      .parameters = {{.name = "log_scale",
                      .unit = "1",
                      .lower = -1.5,
                      .upper = 1.5,
                      .typical = 0.2,
                      .meaning = "logarithm of the frame's scale over the mean; one number for each frame but the "
                                 "first"}},
      .conditions = {"tracks.frame", "camera.image-radius"},
      .mistaken_for = {{.with = "deformation",
                        .told_apart = "keep a rigid thing in the picture: it changes its size only with the scale"},
                       {.with = "tracks.perspective",
                        .told_apart = "follow points in front of and behind each other: perspective draws them apart"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
