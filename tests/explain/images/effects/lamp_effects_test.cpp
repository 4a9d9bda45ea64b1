// Lamps that are not what was written down: with a cone, in another place with their shadows, one nobody wrote down,
// one that flickers. Recorded by the path tracer, which casts every shadow and knows cones from lib/light.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "effect_world.h"
#include "manifest/document.h"
#include "mechanism/mechanism.h"

namespace gonio::tests {
namespace {

using testing::ElementsAre;

// All that a lamp can be mistaken for.
std::vector<std::string> lamp_rivals() {
  return {"light.lobe",          "light.position", "light.direction",   "light.second-source",       "light.ambient",
          "light.finite-size",   "light.drift",    "optics.vignetting", "surface.diffuse-roughness", "sensor.exposure",
          "sensor.non-linearity"};
}

TEST(Spot, WithASoftConeIsALobe) {
  EffectWorld world;
  world.truth = R"("light.lobe":{"outer_rad":0.42,"inner_share":0.3,"exponent":0})";
  const EffectOutcome outcome(world, lamp_rivals());
  ASSERT_THAT(outcome.named(), ElementsAre("light.lobe")) << outcome.told();
  EXPECT_NEAR(outcome.fitted("outer_rad"), 0.42, 0.02);
  EXPECT_NEAR(outcome.fitted("inner_share"), 0.3, 0.1);
}

// With the shadow that moved.
TEST(LampPlace, OfALampThatStandsElsewhereIsNamed) {
  EffectWorld world;
  world.truth = R"("light.position":{"on":["lamp-1"],"shift_x_m":0.04,"shift_y_m":-0.02,"shift_z_m":0.01})";
  const EffectOutcome outcome(world, lamp_rivals());
  ASSERT_THAT(outcome.named(), ElementsAre("light.position")) << outcome.told();
  EXPECT_NEAR(outcome.fitted("lamp-1.shift_x_m"), 0.04, 0.003);
  EXPECT_NEAR(outcome.fitted("lamp-1.shift_y_m"), -0.02, 0.003);
  EXPECT_NEAR(outcome.fitted("lamp-1.shift_z_m"), 0.01, 0.005);
}

// Relative RMSE of predictions with these amounts over the pictures that lamp-1 lights.
double off_by(const explain::images::ImagesProblem& problem, const std::map<std::string, double>& amounts) {
  std::vector<double> values;
  for (const explain::Parameter& p : problem.parameters()) {
    const auto found = amounts.find(p.name);
    values.push_back(found == amounts.end() ? p.neutral : found->second);
  }
  const explain::Observations& o = problem.observations();
  double sum = 0, norm = 0;
  for (std::size_t g = 1; g < o.groups(); g += 2) {
    std::vector<double> prediction(o.first[g + 1] - o.first[g]);
    problem.predict(values, g, prediction);
    for (std::size_t i = 0; i < prediction.size(); ++i) {
      const double r = o.value[o.first[g] + i] - prediction[i];
      sum += r * r, norm += o.norm[o.first[g] + i];
    }
  }
  return std::sqrt(sum / norm);
}

// A prediction with a moved lamp is about as good as one of a model whose lamp stands where it is.
TEST(LampPlace, ShadowsGoWithTheLamp) {
  EffectWorld world;
  world.spp = 400;
  world.noise = 1e-6;
  const ScratchFolder as_written, elsewhere;
  const explain::images::ImagesProblem there(world.record(as_written), {.pixels = 3000});
  world.truth = R"("light.position":{"on":["lamp-1"],"shift_x_m":0.05,"shift_y_m":-0.02})";
  const explain::images::ImagesProblem moved(world.record(elsewhere), {.pixels = 3000});
  const double floor = off_by(there, {}), before = off_by(moved, {}),
               after = off_by(moved,
                              {{"light.position@lamp-1.shift_x_m", 0.05}, {"light.position@lamp-1.shift_y_m", -0.02}});
  EXPECT_GT(before, 4 * floor);
  EXPECT_LT(after, 0.25 * before + floor) << floor << " " << before << " " << after;
}

// A white wall behind the ball sends lamp-1's light on to the table. Of a lamp that fades to the sides it gets a part,
// and the table beside it another: one factor for all light by way of surfaces is wrong at both.
TEST(Lobe, LightByWayOfAWallFadesWithWhatTheWallGets) {
  EffectWorld world;
  world.spp = 400;
  world.noise = 1e-6;
  world.more_meshes = R"(,"wall":{"plane":{"size_m":[1.2,1.2]}})";
  world.more_surfaces = R"(,"wall":{"model":"diffuse","albedo":{"value":[0.8,0.8,0.8],"free":true}})";
  world.more_objects = R"(,{"id":"wall","mesh":"wall","surface":"wall","world_from_object":)"
                       R"({"matrix":[[0,0,1,-0.2],[1,0,0,0],[0,1,0,0.3],[0,0,0,1]]}})";
  const ScratchFolder all_round, fading;
  const explain::images::ImagesProblem there(world.record(all_round), {.pixels = 2000});
  world.truth = R"("light.lobe":{"exponent":4})";
  const explain::images::ImagesProblem lobed(world.record(fading), {.pixels = 2000});
  const double floor = off_by(there, {}), before = off_by(lobed, {}),
               after = off_by(lobed, {{"light.lobe.exponent", 4}});
  EXPECT_GT(before, 10 * floor);
  EXPECT_LT(after, 1.5 * floor) << floor << " " << before << " " << after;
}

TEST(SecondSource, AtAFiniteDistanceIsFound) {
  EffectWorld world;
  world.truth =
      R"("light.second-source":{"watt_per_m2":0.25,"azimuth_rad":2.4,"elevation_rad":0.7,"nearness_per_m":2.5})";
  const EffectOutcome outcome(world, lamp_rivals());
  ASSERT_THAT(outcome.named(), ElementsAre("light.second-source")) << outcome.told();
  EXPECT_NEAR(outcome.fitted("azimuth_rad"), 2.4, 0.05);
  EXPECT_NEAR(outcome.fitted("elevation_rad"), 0.7, 0.05);
  EXPECT_NEAR(outcome.fitted("nearness_per_m"), 2.5, 0.4);
}

// Lit by lamp-0 alone, which a lamp that is always on would not be.
TEST(Reflector, BesideOneLampIsNamed) {
  EffectWorld world;
  world.truth =
      R"("light.reflector":{"on":["lamp-0"],"share":0.3,"offset_x_m":0.1,"offset_y_m":0.25,"offset_z_m":-0.05})";
  std::vector<std::string> rivals = lamp_rivals();
  rivals.push_back("light.reflector");
  const EffectOutcome outcome(world, rivals);
  ASSERT_THAT(outcome.named(), ElementsAre("light.reflector")) << outcome.told();
  EXPECT_EQ(outcome.problem.candidates()[outcome.explanation.named[0]].on, std::vector<std::string>{"lamp-0"});
  EXPECT_NEAR(outcome.fitted("offset_y_m"), 0.25, 0.05);
}

TEST(Exposure, OfSinglePicturesIsNamedWithTheirNumbersAlone) {
  EffectWorld world;
  world.views = 4;
  world.truth = R"("sensor.exposure":{"on":["11","20"],"relative":[0.08,-0.05]})";
  const EffectOutcome outcome(world, lamp_rivals());
  ASSERT_THAT(outcome.named(), ElementsAre("sensor.exposure")) << outcome.told();
  EXPECT_EQ(outcome.problem.candidates()[outcome.explanation.named[0]].on, (std::vector<std::string>{"11", "20"}));
  EXPECT_NEAR(outcome.fitted("11.relative"), 0.08, 0.01);
  EXPECT_NEAR(outcome.fitted("20.relative"), -0.05, 0.01);
}

TEST(Lamps, AsWrittenDownAreNotAccused) {
  EffectWorld world;
  world.noise_seed = 11;
  const EffectOutcome outcome(world, lamp_rivals());
  EXPECT_THAT(outcome.named(), ElementsAre()) << outcome.told();
}

}  // namespace
}  // namespace gonio::tests
