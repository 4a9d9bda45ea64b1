// transport.caustic: light that glass and other smooth interfaces gather and throw on what lies behind. render traces
// it by itself, as much as there is (render/light_tracer.h); a share of it is a matter of explain alone.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& transport_caustic() {
  static const Mechanism declaration{
      .id = "transport.caustic",
      .sentence = "Light that passes through glass is gathered into bright lines and spots behind it.",
      .typical = "large, but local: up to many times the lamp's own light",
      .equation =
          "E(x) += strength times the irradiance by lamps by way of smooth interfaces alone (lamp S+ D); 0: glass "
          "casts "
          "a plain shadow, 1: all of it",
      .source = "Arvo 1986, Backward ray tracing; Jensen 1996 (density of photons)",
      .stage = "transport",
      .target = Target::scene,
      .domains = {"images"},
      .parameters = {{.name = "strength",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1.5,
                      .start = 0.5,
                      .typical = 1,
                      .meaning = "share of the light through smooth interfaces that is simulated"}},
      .conditions = {"light.visibility", "image.radiance"},
      .mistaken_for = {{.with = "light.second-source", .told_apart = "cover the glass"},
                       {.with = "transport.indirect", .told_apart = "cover the glass"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
