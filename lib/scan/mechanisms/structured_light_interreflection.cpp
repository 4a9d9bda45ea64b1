// structured-light.interreflection: cosines that other parts of the thing send on. Equation: light of paths,
// explain/clouds/indirect_light.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& structured_light_interreflection() {
  static const Mechanism declaration{
      .id = "structured-light.interreflection",
      .sentence =
          "Walls of the thing light each other with what the projector shows there: in grooves and hollows the phase "
          "is that of several places.",
      .typical = "0.01 to 1 mm within a period of an inner edge",
      .equation =
          "phase = arg(sum over shown cosines' light that comes by n further points of the thing, albedo^n E(q_n) / "
          "E(p) exp(i (theta(q_n) - theta(p)))), n from 0 on, directions spread by their cosine",
      .source = "Gupta, Agrawal, Veeraraghavan & Narasimhan 2011, section 3; Kajiya 1986, equation 1",
      .stage = "transport",
      .target = Target::scene,
      .domains = {"clouds"},
      .parameters = {{.name = "albedo",
                      .unit = "1",
                      .lower = 0,
                      .upper = 1,
                      .start = 0.5,
                      .typical = 0.5,
                      .meaning = "albedo of the thing taken as matt"}},
      .conditions = {"surface.openness", "projector.phase"},
      .mistaken_for = {{.with = "structured-light.subsurface",
                        .told_apart = "spray the thing with a dark matt lacquer"},
                       {.with = "projector.gamma", .told_apart = "measure a plane"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
