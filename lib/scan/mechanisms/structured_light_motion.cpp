// structured-light.motion: a thing that moves while patterns are shown. Equation: scan/told_place.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& structured_light_motion() {
  static const Mechanism declaration{
      .id = "structured-light.motion",
      .sentence =
          "The thing moves while the patterns are shown one after the other: every shift sees another phase, and "
          "the surface ripples with twice the phase.",
      .typical = "0.05 to 1 mm during a sequence",
      .equation =
          "frame k of n sees the surface along_m (k / (n - 1) - 1/2) farther along the first camera's axis; the "
          "phase is what least squares make of these readings",
      .source = "Weise, Leibe & Van Gool 2007 (motion in phase shifting)",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"clouds"},
      .parameters = {{.name = "along_m",
                      .unit = "m",
                      .lower = -0.01,
                      .upper = 0.01,
                      .start = 2e-4,
                      .typical = 3e-4,
                      .meaning = "from the first frame to the last, away from the camera, of each cloud"}},
      .conditions = {"projector.phase"},
      .mistaken_for = {{.with = "projector.gamma", .told_apart = "measure it again, standing still"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
