// What lenses and sensors do, made by another route than the terms that explain fits: rays through a lens of finite
// size; a pattern multiplied onto the recorded pixels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "effect_world.h"

namespace gonio::tests {
namespace {

using testing::ElementsAre;

TEST(Defocus, ALensThatIsFocusedBehindTheSceneIsNamed) {
  EffectWorld world;
  world.truth = R"("optics.defocus":{"aperture_radius_m":0.012,"focus_m":1.0})";
  const EffectOutcome outcome(world);
  ASSERT_THAT(outcome.named(), ElementsAre("optics.defocus")) << outcome.explanation.sentence;
  // Discs of 2 A f |1/z - 1/F| pixels: what the picture shows well is the disc at the ball, half a metre away.
  const auto disc = [](double radius, double focus) { return radius * std::abs(1 / 0.53 - 1 / focus); };
  EXPECT_NEAR(disc(outcome.fitted("aperture_radius_m"), outcome.fitted("focus_m")), disc(0.012, 1.0),
              0.1 * disc(0.012, 1.0));
}

// Any pattern will do: here noise of its own generator, the same in all pictures.
void with_pattern(io::Image& picture, double sigma) {
  for (std::size_t i = 0; i < picture.data.size(); ++i)
    picture.data[i] *= static_cast<float>(1 + sigma * Random(99, i).normal());
}

TEST(Prnu, APatternThatStaysWhileTheSceneMovesIsNamed) {
  EffectWorld world;
  world.change = [](std::size_t, std::size_t, io::Image& picture) { with_pattern(picture, 0.03); };
  const EffectOutcome outcome(world);
  ASSERT_THAT(outcome.named(), ElementsAre("sensor.prnu")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("sigma"), 0.03, 0.003);
}

TEST(Prnu, CannotBeSeenFromOneView) {
  EffectWorld world;
  world.views = 1;
  world.lamps = 4;
  world.change = [](std::size_t, std::size_t, io::Image& picture) { with_pattern(picture, 0.03); };
  const EffectOutcome outcome(world, {"sensor.prnu", "light.ambient"});
  EXPECT_THAT(outcome.named(), ElementsAre()) << outcome.explanation.sentence;
  bool said = false;
  for (const explain::Isolability& i : outcome.explanation.isolability)
    if (outcome.problem.candidates()[i.candidate].id() == "sensor.prnu") said = !i.visible;
  EXPECT_TRUE(said);
}

}  // namespace
}  // namespace gonio::tests
