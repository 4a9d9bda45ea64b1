// projector.lens: the distortion of a projector's lens. Equation: camera/lens_terms.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& projector_lens() {
  static const Mechanism declaration{
      .id = "projector.lens",
      .sentence = "The projector's lens bends the lines that it shows, as a camera's lens bends those that it sees.",
      .typical = "1 to 20 px at the corners of short-throw projectors",
      .equation =
          "as lens.radial and lens.tangential, of the projector as a camera that looks backwards: "
          "(x', y') = (x, y) (1 + k1 r^2 + k2 r^4) + decentring p1, p2",
      .source = "Moreno & Taubin 2012, section 4; Brown 1971, equation 9",
      .stage = "light",
      .target = Target::camera,
      .domains = {"clouds"},
      .parameters =
          {{.name = "k1", .unit = "1", .lower = -1, .upper = 1, .typical = 0.1, .meaning = "third-order radial term"},
           {.name = "k2", .unit = "1", .lower = -10, .upper = 10, .typical = 0.2, .meaning = "fifth-order radial term"},
           {.name = "p1",
            .unit = "1",
            .lower = -0.2,
            .upper = 0.2,
            .typical = 0.003,
            .meaning = "decentring, stretches along y"},
           {.name = "p2",
            .unit = "1",
            .lower = -0.2,
            .upper = 0.2,
            .typical = 0.003,
            .meaning = "decentring, stretches along x"}},
      .conditions = {"projector.image-radius"},
      .mistaken_for = {{.with = "lens.radial",
                        .told_apart = "let a second camera look on, or turn the rig about the shape"},
                       {.with = "projector.moved", .told_apart = "measure a plane at two ranges"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
