// Lamps and surfaces: polarized light carried through Mueller matrices by the path tracer, lobes with a direction,
// walls that stand near.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "effect_world.h"
#include "manifest/document.h"

namespace gonio::tests {
namespace {

using testing::ElementsAre;

// What the effect at hand could be mistaken for, and a few others.
std::vector<std::string> rivals(const std::string& id) {
  std::vector<std::string> ids{"surface.diffuse-roughness", "surface.specular", "surface.anisotropy",
                               "light.direction",           "light.ambient",    "optics.vignetting"};
  if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  return ids;
}

constexpr const char* glazed =
    R"({"model":"coated-diffuse","albedo":{"value":[0.5,0.4,0.3],"free":true},"f0":0.05,"alpha":0.3})";

TEST(Polarization, OfTheLampsIsNamed) {
  EffectWorld world;
  world.ball = world.table = glazed;
  world.stokes = true;
  world.truth = R"("light.polarization":{"on":["lamp-0","lamp-1"],"degree_0":[0.8,-0.5],"degree_45":[0.1,0.6]})";
  const EffectOutcome outcome(world, rivals("light.polarization"));
  ASSERT_THAT(outcome.named(), ElementsAre("light.polarization")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("lamp-0.degree_0"), 0.8, 0.08);
  EXPECT_NEAR(outcome.fitted("lamp-1.degree_45"), 0.6, 0.08);
}

TEST(Anisotropy, OfAGlossIsNamed) {
  EffectWorld world;
  world.ball = R"({"model":"coated-diffuse","albedo":{"value":[0.3,0.2,0.2],"free":true},"f0":0.08,"alpha":0.25})";
  world.truth = R"("surface.anisotropy":{"on":["ball"],"anisotropy_0":0.4,"anisotropy_45":-0.2})";
  const EffectOutcome outcome(world, rivals("surface.anisotropy"));
  ASSERT_THAT(outcome.named(), ElementsAre("surface.anisotropy")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("anisotropy_0"), 0.4, 0.06);
  EXPECT_NEAR(outcome.fitted("anisotropy_45"), -0.2, 0.06);
}

TEST(NearEnvironment, WallsInsteadOfASkyAreNamed) {
  EffectWorld world;
  world.views = 4;
  world.lights_together = true;
  world.table = R"({"model":"diffuse","albedo":[0,0,0]})";  // on which shadows would move
  for (const char* towards : {"[1,0,0.6]", "[-0.6,0.9,0.5]", "[-0.3,-0.8,0.7]", "[0.1,0.1,1]"})
    world.lights.push_back(std::string(R"({"model":"directional","towards":)") + towards +
                           R"(,"watt_per_m2":{"value":[0.8,0.8,0.8],"free":true,"share":"lamp"}})");
  world.truth = R"("light.near-environment":{"nearness_per_m":0.7})";
  const EffectOutcome outcome(world, rivals("light.near-environment"));
  ASSERT_THAT(outcome.named(), ElementsAre("light.near-environment")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("nearness_per_m"), 0.7, 0.07);
}

// What blue light excites returns in green and red: made by adding a picture of the ball lit by blue light alone, as a
// white ball would show it, to those bands.
TEST(Fluorescence, UnderLampsOfDifferentColoursIsNamed) {
  EffectWorld world;
  world.lamps = 3;
  world.lights = {R"({"model":"point","position_m":[0.3,-0.3,0.4],"watt_per_sr":[0.7,0.6,0.2]})",
                  R"({"model":"point","position_m":[-0.35,-0.1,0.45],"watt_per_sr":[0.3,0.5,0.9]})",
                  R"({"model":"point","position_m":[0.05,0.25,0.5],"watt_per_sr":[0.6,0.6,0.6]})"};
  EffectWorld white = world;
  white.ball = R"({"model":"diffuse","albedo":[1,1,1]})";
  white.table = R"({"model":"diffuse","albedo":[0,0,0]})";
  const std::vector<io::Image> excited = white.render();
  world.change = [&](std::size_t image, std::size_t, io::Image& picture) {
    for (std::size_t i = 0; i < picture.pixels(); ++i) {
      const float blue = excited[image].data[3 * i + 2];
      picture.data[3 * i] += 0.02f * blue;
      picture.data[3 * i + 1] += 0.06f * blue;
    }
  };
  const EffectOutcome outcome(world);
  ASSERT_THAT(outcome.named(), ElementsAre("surface.fluorescence")) << outcome.explanation.sentence;
}

TEST(Fluorescence, IsNoQuestionUnderLampsOfOneColour) {
  EffectWorld world;
  world.views = 1;
  world.spp = 4;
  const ScratchFolder folder;
  const explain::images::ImagesProblem problem(world.record(folder), {.pixels = 300});
  for (const explain::Candidate& c : problem.candidates()) EXPECT_NE(c.id(), "surface.fluorescence");
}

TEST(Caustic, BehindAGlassBallIsNamed) {
  EffectWorld world;
  world.spp = 400;
  world.ball = R"({"model":"dielectric","eta":1.1})";  // gathers gently: no spot outshines all
  const EffectOutcome outcome(world, rivals("transport.caustic"));
  ASSERT_THAT(outcome.named(), ElementsAre("transport.caustic")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("strength"), 1, 0.05);
}

}  // namespace
}  // namespace gonio::tests
