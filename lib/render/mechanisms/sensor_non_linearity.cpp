// sensor.non-linearity: the reading bends away from the light. Its forms are alternatives, from the quadratic with one
// number to the tone curve; explain fits one of them at a time and names the simplest that suffices.
#include "render/mechanisms/sensor_non_linearity.h"

#include <algorithm>
#include <cmath>

namespace gonio::equation {
namespace {

// (1 + a) u^g - a, 0 < g < 1, with the line through zero that touches it at u0: there (1 + a) (1 - g) u0^g = a. A toe
// that reaches beyond the reference leaves a line.
struct ScreenCoding {
  double g, a, power_at_touch, touch, slope;
  ScreenCoding(double gamma, double toe)
      : g(gamma),
        a(toe),
        power_at_touch(a / ((1 + a) * (1 - g))),
        touch(std::pow(power_at_touch, 1 / g)),
        slope(((1 + a) * power_at_touch - a) / touch) {}
  bool line() const { return !(power_at_touch < 1) || !(touch > 0); }
  double coded(double u) const { return u <= touch ? slope * u : (1 + a) * std::pow(u, g) - a; }
  double decoded(double r) const { return r <= slope * touch ? r / slope : std::pow((r + a) / (1 + a), 1 / g); }
};

}  // namespace

double sensor_power_law(double v, double gamma, double reference, double toe) {
  const double u = std::abs(v / reference);
  if (!(toe > 0)) return reference * std::copysign(std::pow(u, gamma), v);
  if (gamma == 1) return v;
  const ScreenCoding screen(std::min(gamma, 1 / gamma), toe);
  if (screen.line()) return v;
  return reference * std::copysign(gamma < 1 ? screen.coded(u) : screen.decoded(u), v);
}

double sensor_shoulder(double v, double shoulder, double reference) {
  return v * (1 + shoulder) / (1 + shoulder * std::abs(v / reference));
}
// Beyond what the shoulder ever reaches: as much light as a hundred times that much would need.
double sensor_shoulder_undone(double reading, double shoulder, double reference) {
  return reading / std::max(0.01, 1 + shoulder - shoulder * std::abs(reading / reference));
}

render::Response sensor_non_linearity(std::span<const double> parameters) {
  render::ToneBends bends;
  std::copy_n(parameters.begin() + 6, bends.size(), bends.begin());
  return {.quadratic = parameters[0],
          .gamma = parameters[2],
          .reference = parameters[1],
          .curve = render::ToneCurve(render::slopes_of(parameters[5], bends)),
          .toe = parameters[3],
          .shoulder = parameters[4]};
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
       .typical = 0.02,
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
       .typical = 0.15,
       .meaning = "exponent of a power law: reading over reference is light over reference to this power"},
      {.name = "toe",
       .unit = "1",
       .neutral = 0,
       .lower = 0,
       .upper = 0.5,
       .start = 0.05,
       .typical = 0.05,
       .meaning = "linear toe of the power law, as screens are coded (0.055 with gamma 1 / 2.4 is sRGB): (1 + toe) "
                  "times the power, less toe, and a line where that would turn; without effect at gamma 1"},
      {.name = "shoulder",
       .unit = "1",
       .neutral = 0,
       .lower = 0,
       .upper = 100,
       .start = 0.5,
       .typical = 0.5,
       .meaning =
           "bends bright light down: (1 + shoulder) / (1 + shoulder v / reference) times the value; with a gamma "
           "above 1 the s-curve of film"},
      {.name = "slope",
       .unit = "1",
       .neutral = 1,
       .lower = 0.05,
       .upper = 20,
       .start = 1.1,
       .typical = 0.2,
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
          "v *= 1 + quadratic v / reference; or v = reference (v / reference)^gamma, with a linear toe where it is "
          "given; then v *= (1 + shoulder) / (1 + shoulder v / reference); or a tone curve, "
          "d ln(light) / d ln(v) = slope at v = reference / 4, exp(bend_k) times as much from node to node outwards, "
          "linear in ln(v) between",
      .source =
          "EMVA Standard 1288, release 4.0, linearity (second order); IEC 61966-2-1 (toe); Reinhard & "
          "Devlin 2005, equation 1 (s-curve); Debevec & Malik 1997, equation 3",
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
