// Tone curves of other people's making on pictures of a scene: a power law, the coding of screens as IEC 61966-2-1
// writes it, and a film-like s-curve with its author's published constants. The response is found as such and in a form
// that follows the curve; where nothing bends, none is found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "effect_world.h"
#include "inference/explanation.h"
#include "render/mechanisms/sensor_non_linearity.h"

namespace gonio::tests {
namespace {

using testing::ElementsAre;
using Curve = std::function<double(double)>;

constexpr double white = 0.6;  // about the brightest reading of the world

double power_law(double v) {
  return std::pow(v, 0.88);
}
double screen(double v) {
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}
// J. Hable, Uncharted 2: HDR lighting, Game Developers Conference 2010.
double film(double v) {
  constexpr double a = 0.15, b = 0.5, c = 0.1, d = 0.2, e = 0.02, f = 0.3;
  const double x = 4 * v;
  return 3 * ((x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f);
}

EffectOutcome seen_through(const Curve& curve) {
  EffectWorld world;
  if (curve)
    world.change = [&](std::size_t, std::size_t, io::Image& picture) {
      for (float& v : picture.data) v = static_cast<float>(white * curve(v / white));
    };
  return EffectOutcome(world, {"sensor.non-linearity", "sensor.black-offset", "optics.veiling-glare", "light.position",
                               "surface.interface", "surface.diffuse-roughness"});
}

render::Response response_of(const EffectOutcome& outcome) {
  const std::size_t c = outcome.explanation.named.at(0);
  const auto& use = outcome.problem.model().uses()[outcome.problem.bindings().use_of[c]];
  return equation::sensor_non_linearity(use.amounts(outcome.problem.state(outcome.explanation.values)));
}

// d ln(reading) / d ln(light), which does not depend on how bright the lamps are; both where the reading is the same.
double slope(const Curve& curve, double v) {
  return (std::log(curve(1.02 * v)) - std::log(curve(v / 1.02))) / (2 * std::log(1.02));
}
void expect_follows(const EffectOutcome& outcome, const Curve& truth, double tolerance) {
  const render::Response response = response_of(outcome);
  for (const double light : {0.08, 0.15, 0.3, 0.5, 0.8}) {
    const double reading = white * truth(light);
    EXPECT_NEAR(slope(response, response.light(reading)), slope(truth, light), tolerance) << light;
  }
}

TEST(Tone, NothingIsFoundWhereNothingBends) {
  const EffectOutcome outcome = seen_through({});
  EXPECT_THAT(outcome.named(), ElementsAre()) << outcome.explanation.sentence;
}

TEST(Tone, APowerLawIsNamedWithItsExponentAlone) {
  const EffectOutcome outcome = seen_through(power_law);
  ASSERT_THAT(outcome.named(), ElementsAre("sensor.non-linearity")) << outcome.explanation.sentence;
  ASSERT_EQ(outcome.explanation.estimates.size(), 1u);
  const explain::Estimate& gamma = outcome.explanation.estimates[0];
  EXPECT_NEAR(gamma.value, 0.88, 0.015);
  EXPECT_LE(gamma.lower_95, 0.88);
  EXPECT_GE(gamma.upper_95, 0.88);
}

TEST(Tone, TheCodingOfScreensIsFollowed) {
  const EffectOutcome outcome = seen_through(screen);
  ASSERT_THAT(outcome.named(), ElementsAre("sensor.non-linearity")) << outcome.explanation.sentence;
  EXPECT_LE(outcome.explanation.estimates.size(), 2u);
  expect_follows(outcome, screen, 0.03);
}

TEST(Tone, FilmIsFollowed) {
  const EffectOutcome outcome = seen_through(film);
  ASSERT_THAT(outcome.named(), ElementsAre("sensor.non-linearity")) << outcome.explanation.sentence;
  EXPECT_GT(outcome.explanation.estimates.size(), 1u);
  expect_follows(outcome, film, 0.06);
}

}  // namespace
}  // namespace gonio::tests
