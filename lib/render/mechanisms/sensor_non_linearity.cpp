// sensor.non-linearity: the reading bends away from the light. Its three forms are
// alternatives; explain fits one of them at a time.
#include "render/mechanisms/sensor_non_linearity.h"

#include <algorithm>

namespace gonio::equation {

render::Response sensor_non_linearity(std::span<const double> parameters) {
  render::ToneBends bends;
  std::copy_n(parameters.begin() + 4, bends.size(), bends.begin());
  return {parameters[0], parameters[2], parameters[1], render::ToneCurve(render::slopes_of(parameters[3], bends))};
}

}  // namespace gonio::equation

namespace gonio::mechanism {
namespace {

std::vector<Parameter> parameters_of_response() {
  std::vector<Parameter> all = {
      {.name = "quadratic",
       .unit = "1",
       .neutral = 0,
       .lower = -0.5,
       .upper = 0.5,
       .start = -0.02,
       .meaning = "relative departure from proportionality at the value reference"},
      {.name = "reference",
       .unit = "W/(m^2 sr)",
       .neutral = 1,
       .lower = 1e-06,
       .upper = 1000000.0,
       .start = 1,
       .meaning = "value at which light and reading agree, and at which the quadratic's departure is stated; without "
                  "effect where the others are neutral"},
      {.name = "gamma",
       .unit = "1",
       .neutral = 1,
       .lower = 0.1,
       .upper = 5,
       .start = 0.9,
       .meaning = "exponent of a power law: reading over reference is light over reference to this power"},
      {.name = "slope",
       .unit = "1",
       .neutral = 1,
       .lower = 0.05,
       .upper = 20,
       .start = 1.1,
       .meaning = "tone curve: d ln(light) / d ln(reading) where the reading is a quarter of the reference"},
  };
  // Nodes: 1, 2, 4, 6, 8, 12, 16 (the anchor), 24, 32, 48 and 64 of 64.
  for (std::size_t k = 1; k < render::tone_nodes.size(); ++k)
    all.push_back({.name = "bend_" + std::to_string(k),
                   .unit = "1",
                   .neutral = 0,
                   .lower = -4,
                   .upper = 4,
                   .start = 0.02,
                   .meaning = "tone curve: logarithm of the slope at the outer over that at the inner of its nodes " +
                              std::to_string(k) + " and " + std::to_string(k + 1)});
  return all;
}

}  // namespace

const Mechanism& sensor_non_linearity() {
  static const Mechanism declaration{
      .id = "sensor.non-linearity",
      .sentence = "The reading does not grow in proportion to the light.",
      .typical = "0.3 to 2 % (film and JPEG: far more)",
      .equation =
          "v *= 1 + quadratic v / reference; or v = reference (v / reference)^gamma; or a tone curve, "
          "d ln(light) / d ln(v) = slope at v = reference / 4, exp(bend_k) times as much from node to node outwards, "
          "linear in ln(v) between",
      .source = "EMVA Standard 1288, release 4.0, linearity (second order); Debevec & Malik 1997, equation 3",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"tables", "stacks", "images"},
      .parameters = parameters_of_response(),
      .conditions = {"image.radiance"},
      .mistaken_for = {{.with = "surface.specular", .told_apart = "exposure ramp"},
                       {.with = "sensor.black-offset", .told_apart = "lens cap"},
                       {.with = "sensor.saturation", .told_apart = "shorter exposure"}},
      .act = [](double v, std::span<const double>,
                std::span<const double> p) { return equation::sensor_non_linearity(p)(v); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
