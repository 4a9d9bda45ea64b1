// Cameras that see things elsewhere than the scene says: what the terms predict is held against pictures whose rays
// were cast where the mechanism puts them, and pictures that the path tracer made with it are explained by it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "effect_world.h"
#include "manifest/document.h"

namespace gonio::tests {
namespace {

using explain::images::ImagesProblem;
using testing::Contains;
using testing::ElementsAre;

// Two balls before a table: edges near and far, shadows.
EffectWorld two_balls() {
  EffectWorld world;
  world.more_meshes = R"(,"bead":{"sphere":{"radius_m":0.04}})";
  world.more_surfaces = R"(,"bead":{"model":"diffuse","albedo":{"value":[0.2,0.5,0.6],"free":true}})";
  world.more_objects = R"(,{"id":"bead","mesh":"bead","surface":"bead","world_from_object":{"rotation":[1,0,0,0],)"
                       R"("translation_m":[0.1,0.13,0.041]}})";
  return world;
}

// The prediction with a mechanism in play, over the one of a model whose cameras have it: rms of the difference over
// the rms of what it changes.
double missed(const EffectWorld& world, const ScratchFolder& folder, const ImagesProblem& believed,
              const std::string& id, const std::map<std::string, double>& amounts) {
  std::string text;
  for (const auto& [name, value] : amounts)
    text += (text.empty() ? "" : ",") + ("\"" + name + "\":") + std::to_string(value);
  const std::string on = id == "camera.pose" ? R"("on":["camera"],)" : "";
  const manifest::Document truth =
      manifest::parse_document(world.manifest("\"" + id + "\":{" + on + text + "}"), "truth", folder.path());
  const ImagesProblem moved(truth, {.pixels = 3000});
  std::vector<double> neutral, values;
  for (const explain::Parameter& p : believed.parameters()) neutral.push_back(p.neutral);
  values = neutral;
  bool found = false;
  for (const explain::Candidate& c : believed.candidates()) {
    if (c.id() != id || c.on != std::vector<std::string>{"camera"}) continue;
    found = true;
    for (const std::size_t p : c.parameters) {
      const std::string& full = believed.parameters()[p].name;
      const auto amount = amounts.find(full.substr(full.rfind('.') + 1));
      if (amount != amounts.end()) values[p] = amount->second;
    }
  }
  EXPECT_TRUE(found) << id;
  std::vector<double> base_of_moved;
  for (const explain::Parameter& p : moved.parameters()) base_of_moved.push_back(p.neutral);
  double off = 0, change = 0;
  for (std::size_t g = 0; g < believed.observations().groups(); ++g) {
    const std::size_t rows = believed.observations().first[g + 1] - believed.observations().first[g];
    std::vector<double> before(rows), after(rows), want(rows);
    believed.predict(neutral, g, before);
    believed.predict(values, g, after);
    moved.predict(base_of_moved, g, want);
    for (std::size_t i = 0; i < rows; ++i) {
      off += (after[i] - want[i]) * (after[i] - want[i]);
      change += (want[i] - before[i]) * (want[i] - before[i]);
    }
  }
  return std::sqrt(off / change);
}

// 0.15 is wanted; what is larger is what is reached, and a shortcoming.
struct Case {
  const char* id;
  std::map<std::string, double> amounts;
  double most;  // that may be missed
};

TEST(Displaced, PredictionsAreThoseOfRaysCastElsewhere) {
  EffectWorld world = two_balls();
  world.views = 2;
  world.spp = 4;
  const std::vector<Case> cases{
      {"lens.radial", {{"k1", -0.3}}, 0.2},
      {"lens.tangential", {{"p1", 0.02}, {"p2", -0.015}}, 0.3},
      {"lens.thin-prism", {{"s1", 0.03}, {"s3", 0.02}}, 0.5},
      {"lens.fisheye", {{"fisheye", 0.6}}, 0.2},
      {"lens.non-central", {{"pupil_m", 0.03}}, 0.65},
      {"camera.focal-length", {{"relative", 0.03}}, 0.2},
      {"camera.principal-point", {{"x_px", 0.7}, {"y_px", -0.4}}, 0.15},
      {"camera.principal-point", {{"x_px", 7}, {"y_px", -6}}, 0.15},
      {"camera.aspect", {{"relative", 0.03}}, 0.2},
      {"camera.pose", {{"x_m", 0.004}, {"y_m", 0.003}, {"turn_z_rad", 0.01}}, 0.15},
      {"camera.pose", {{"x_m", 0.03}, {"z_m", 0.02}, {"turn_y_rad", -0.02}}, 0.25},
      {"camera.rolling-shutter", {{"motion_x_m", 0.012}, {"motion_y_m", 0.006}}, 0.2},
  };
  const ScratchFolder folder;
  const ImagesProblem believed(world.record(folder), {.pixels = 3000});
  for (const Case& c : cases) {
    const double share = missed(world, folder, believed, c.id, c.amounts);
    RecordProperty(c.id, std::to_string(share));
    std::printf("%s %.3f\n", c.id, share);
    EXPECT_LT(share, c.most) << c.id;
  }
}

const std::vector<std::string> rivals{
    "lens.radial",    "lens.tangential", "camera.focal-length", "camera.principal-point",
    "camera.aspect",  "camera.pose",     "geometry.pose",       "geometry.scale",
    "optics.defocus", "light.position",  "optics.vignetting",   "light.ambient"};

TEST(Displaced, ALensThatBowsIsNamed) {
  EffectWorld world = two_balls();
  world.truth = R"("lens.radial":{"k1":-0.25})";
  const EffectOutcome outcome(world, rivals);
  ASSERT_THAT(outcome.named(), ElementsAre("lens.radial")) << outcome.explanation.sentence;
  EXPECT_EQ(outcome.explanation.conditions[0].name, "camera.edge-shift-radial");
}

TEST(Displaced, AFocalLengthIsNamed) {
  EffectWorld world = two_balls();
  world.truth = R"("camera.focal-length":{"relative":0.03})";
  const EffectOutcome outcome(world, rivals);
  ASSERT_THAT(outcome.named(), ElementsAre("camera.focal-length")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("relative"), 0.03, 0.002);
}

// As far off as pictures that were cropped by a few pixels.
TEST(Displaced, APrincipalPointFarOffIsNamed) {
  EffectWorld world = two_balls();
  world.truth = R"("camera.principal-point":{"x_px":5.5,"y_px":-4})";
  const EffectOutcome outcome(world, rivals);
  ASSERT_THAT(outcome.named(), ElementsAre("camera.principal-point")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("x_px"), 5.5, 0.1);
  EXPECT_NEAR(outcome.fitted("y_px"), -4, 0.1);
}

TEST(Displaced, OneNudgedViewIsNamedAndNoObject) {
  EffectWorld world = two_balls();
  world.truth = R"("camera.pose":{"on":["10","11"],"x_m":0.004,"turn_z_rad":0.02})";
  const EffectOutcome outcome(world, rivals);
  ASSERT_THAT(outcome.named(), ElementsAre("camera.pose")) << outcome.explanation.sentence;
  EXPECT_THAT(outcome.problem.candidates()[outcome.explanation.named[0]].on, ElementsAre("10", "11"));
  EXPECT_NEAR(outcome.fitted("turn_z_rad"), 0.02, 0.004);
}

TEST(Displaced, AnObjectThatStandsElsewhereIsNoCamera) {
  EffectWorld world = two_balls();
  world.truth = R"("geometry.pose":{"on":["ball"],"shift_x_m":0.004,"shift_y_m":-0.003})";
  const EffectOutcome outcome(world, rivals);
  ASSERT_THAT(outcome.named(), ElementsAre("geometry.pose")) << outcome.explanation.sentence;
}

// Further than a silhouette's slope reaches.
TEST(Displaced, AnObjectFarFromItsPlaceIsFound) {
  EffectWorld world = two_balls();
  world.truth = R"("geometry.pose":{"on":["ball"],"shift_x_m":0.009,"shift_y_m":-0.008})";
  const EffectOutcome outcome(world, rivals);
  ASSERT_THAT(outcome.named(), ElementsAre("geometry.pose")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("shift_x_m"), 0.009, 0.0005);
  EXPECT_NEAR(outcome.fitted("shift_y_m"), -0.008, 0.0005);
}

TEST(Displaced, NothingIsNamedWhereNothingIsLeftOut) {
  const EffectOutcome outcome(two_balls(), rivals);
  EXPECT_THAT(outcome.named(), ElementsAre()) << outcome.explanation.sentence;
}

// What is put into the manifest makes the path tracer's picture the recorded one.
TEST(Displaced, TheAnswerIsRendered) {
  EffectWorld world = two_balls();
  world.views = 2;
  world.truth = R"("lens.radial":{"k1":-0.25})";
  const EffectOutcome outcome(world, {"lens.radial", "camera.focal-length"});
  ASSERT_THAT(outcome.named(), ElementsAre("lens.radial")) << outcome.explanation.sentence;
  EffectWorld answered = world;
  answered.truth = "\"lens.radial\":{\"k1\":" + std::to_string(outcome.fitted("k1")) +
                   ",\"k2\":" + std::to_string(outcome.fitted("k2")) + "}";
  EffectWorld believed = world;
  believed.truth = "";
  const std::vector<io::Image> want = world.render(), before = believed.render(), after = answered.render();
  double off = 0, change = 0;
  for (std::size_t i = 0; i < want.size(); ++i)
    for (std::size_t k = 0; k < want[i].data.size(); ++k) {
      off += std::pow(after[i].data[k] - want[i].data[k], 2);
      change += std::pow(before[i].data[k] - want[i].data[k], 2);
    }
  EXPECT_LT(off, 0.05 * change);
}

}  // namespace
}  // namespace gonio::tests
