// ct.cupping: one material, several values.
#include "volume/mechanisms/ct_cupping.h"

namespace gonio::mechanism {

const Mechanism& ct_cupping() {
  static const Mechanism declaration{
      .id = "ct.cupping",
      .sentence =
          "The gain of the volume changes smoothly from the rotation axis outwards: one material is darker inside than "
          "near the rim.",
      .typical = "2 to 20 %",
      .equation =
          "v' = v (1 + cupping (r^2 / R^2 - 1/2)): r the distance from the rotation axis, R the radius of the field",
      .source = "Hunter & McDavid, Medical Physics 39 (2012) 4904-4918: cupping as a parabola of the radius",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes"},
      .parameters = {{.name = "cupping",
                      .unit = "1",
                      .lower = -0.9,
                      .upper = 0.9,
                      .start = 0.05,
                      .typical = 0.08,
                      .meaning = "gain at the rim of the field less that at the axis, as a share"}},
      .conditions = {"volume.radius", "volume.depth"},
      .mistaken_for = {{.with = "ct.beam-hardening",
                        .told_apart = "look at the air in hollows: only hardening reaches it"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
