// What lenses and sensors do, made by another route than the terms that explain fits: rays through a lens of finite
// size; a pattern multiplied onto the recorded pixels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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

// Of a pattern within the noise the pictures show little; it is as large as it is.
TEST(Prnu, APatternWithinTheNoiseIsNoSmallerThanItsSize) {
  EffectWorld world;
  world.noise = 0.004;
  world.change = [](std::size_t, std::size_t, io::Image& picture) { with_pattern(picture, 0.014); };
  const EffectOutcome outcome(world);
  ASSERT_THAT(outcome.named(), ElementsAre("sensor.prnu")) << outcome.told();
  EXPECT_NEAR(outcome.fitted("sigma"), 0.014, 0.004);
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

// Every pixel into every other one, one by one; the share of the light that this profile holds within `radius` is 29 %.
void with_halos(io::Image& picture, double share, double radius) {
  const io::Image from = picture;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c) {
        double halo = 0;
        for (int v = 0; v < picture.height; ++v)
          for (int u = 0; u < picture.width; ++u) {
            const double q = 1 + ((u - x) * (u - x) + (v - y) * (v - y)) / (radius * radius);
            halo += from.at(u, v, c) / (q * std::sqrt(q) * 2 * pi * radius * radius);
          }
        picture.at(x, y, c) = static_cast<float>((1 - share) * from.at(x, y, c) + share * halo);
      }
}

TEST(Bloom, AHaloAboutBrightPlacesIsNamed) {
  EffectWorld world;
  world.change = [](std::size_t, std::size_t, io::Image& picture) { with_halos(picture, 0.12, 3.0); };
  const EffectOutcome outcome(world);
  ASSERT_THAT(outcome.named(), ElementsAre("optics.bloom")) << outcome.told();
  EXPECT_NEAR(outcome.fitted("share"), 0.12, 0.015);
  EXPECT_NEAR(outcome.fitted("radius_px"), 3.0, 0.6);
}

// Switched on for one picture by its name: the others have none.
TEST(Bloom, IsThatOfThePictureThatItIsSwitchedOnFor) {
  EffectWorld world;
  world.spp = 4;
  const ScratchFolder plain, bloomed;
  const explain::images::ImagesProblem without(world.record(plain), {.pixels = 1000});
  world.believed = R"("optics.bloom":{"share":0.12,"radius_px":3,"on":["00"]})";
  const explain::images::ImagesProblem with(world.record(bloomed), {.pixels = 1000});
  const auto start = [](const explain::Problem& problem) {
    std::vector<double> values;
    for (const explain::Parameter& p : problem.parameters()) values.push_back(p.start);
    for (const explain::Candidate& c : problem.candidates())
      for (const std::size_t p : c.parameters) values[p] = problem.parameters()[p].neutral;
    return values;
  };
  for (std::size_t g = 0; g < with.observations().groups(); ++g) {
    const std::size_t rows = with.observations().first[g + 1] - with.observations().first[g];
    std::vector<double> a(rows), b(rows);
    without.predict(start(without), g, a);
    with.predict(start(with), g, b);
    EXPECT_EQ(a != b, with.observations().group[g] == "00") << with.observations().group[g];
  }
}

// Switched on for every camera, without naming one.
TEST(Bloom, ThatTheSceneHasIsNoneThatIsLeftOut) {
  EffectWorld world;
  world.truth = world.believed = R"("optics.bloom":{"share":0.12,"radius_px":3})";
  const EffectOutcome outcome(world, {"optics.bloom", "optics.veiling-glare", "sensor.non-linearity"});
  EXPECT_THAT(outcome.named(), ElementsAre()) << outcome.told();
}

// Cut off, then resampled by half a pixel to one side and back again, as undistortion does in the worst place.
void clip_and_resample(io::Image& picture, float full_scale) {
  for (float& v : picture.data) v = std::min(v, full_scale);
  for (const int step : {1, -1})
    for (const bool along_x : {true, false}) {
      const io::Image from = picture;
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
          const int u = std::clamp(x + (along_x ? step : 0), 0, picture.width - 1);
          const int v = std::clamp(y + (along_x ? 0 : step), 0, picture.height - 1);
          for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 0.5f * (from.at(x, y, c) + from.at(u, v, c));
        }
    }
}

TEST(ClippedResampling, IsNamedAndNotSaturation) {
  EffectWorld world;
  world.ball = R"({"model":"coated-diffuse","albedo":{"value":[0.5,0.4,0.3],"free":true},"f0":0.08,"alpha":0.2})";
  world.change = [](std::size_t, std::size_t, io::Image& picture) { clip_and_resample(picture, 0.32f); };
  const EffectOutcome outcome(world, {"sensor.clipped-resampling", "sensor.saturation", "sensor.non-linearity",
                                      "surface.specular", "surface.diffuse-roughness", "optics.defocus"});
  ASSERT_THAT(outcome.named(), ElementsAre("sensor.clipped-resampling")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("full_scale"), 0.32, 0.01);
  EXPECT_NEAR(outcome.fitted("width_px"), 2, 0.3);
}

// Where noise is there before the cut, readings about full scale are on average 0.4 of its width less than that.
TEST(Saturation, CutsOffNoise) {
  EffectWorld world;
  world.noise = 0.01, world.full_scale = 0.3;
  const EffectOutcome outcome(world, {"sensor.saturation", "sensor.non-linearity", "optics.veiling-glare"});
  ASSERT_THAT(outcome.named(), ElementsAre("sensor.saturation")) << outcome.told();
  EXPECT_NEAR(outcome.fitted("full_scale"), 0.3, 1e-3);
}

}  // namespace
}  // namespace gonio::tests
