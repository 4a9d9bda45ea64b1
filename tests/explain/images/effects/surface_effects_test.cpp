// Surfaces that are believed matte: recorded by the path tracer, with light that goes through sheets and to and fro
// between bodies, and named from the fast model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "effect_world.h"
#include "manifest/document.h"

namespace gonio::tests {
namespace {

using testing::ElementsAre;

std::vector<std::string> surface_rivals() {
  return {"surface.metal", "surface.interface",   "surface.sheen", "surface.diffuse-roughness",
          "surface.coat",  "surface.translucent", "light.lobe",    "light.ambient"};
}

EffectOutcome seen(const std::string& truth) {
  EffectWorld world;
  world.ball = R"({"model":"diffuse","albedo":{"value":[0.6,0.4,0.3],"free":true}})";
  world.truth = truth;
  return EffectOutcome(world, surface_rivals());
}

TEST(Metal, BelievedMatteIsNamed) {
  const EffectOutcome outcome = seen(R"("surface.metal":{"on":["ball"],"metal":0.7,"metal_alpha":0.4})");
  ASSERT_THAT(outcome.named(), ElementsAre("surface.metal")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("metal"), 0.7, 0.1);
  EXPECT_NEAR(outcome.fitted("metal_alpha"), 0.4, 0.05);
}

TEST(Sheen, OfVelvetIsNamed) {
  const EffectOutcome outcome = seen(R"("surface.sheen":{"on":["ball"],"sheen":0.2,"sheen_width":0.6})");
  ASSERT_THAT(outcome.named(), ElementsAre("surface.sheen")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("sheen"), 0.2, 0.04);
}

TEST(Coat, OnAPartIsNamed) {
  const EffectOutcome outcome =
      seen(R"("surface.coat":{"on":["ball"],"f0":0.06,"alpha":0.3,"azimuth_rad":0.3,"elevation_rad":0.2,)"
           R"("from_m":-0.01,"edge_m":0.004})");
  ASSERT_THAT(outcome.named(), ElementsAre("surface.coat")) << outcome.told();
  EXPECT_NEAR(outcome.fitted("f0"), 0.06, 0.012);
}

TEST(Translucent, ABallLikeALampShadeIsNamed) {
  const EffectOutcome outcome = seen(R"("surface.translucent":{"on":["ball"],"translucent":0.4})");
  ASSERT_THAT(outcome.named(), ElementsAre("surface.translucent")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("translucent"), 0.4, 0.06);
}

// Of a few pixels' width on a table of which a third of a metre is seen.
TEST(Stain, SmallOnATableIsFound) {
  EffectWorld world;
  world.truth = R"("surface.spatial-variation":{"on":["table"],"x_m":0.03,"y_m":0.14,"z_m":0,"width_m":0.02,)"
                R"("depth":-0.4})";
  const EffectOutcome outcome(
      world, {"surface.spatial-variation", "surface.coat", "optics.bloom", "light.lobe", "light.second-source"});
  ASSERT_THAT(outcome.named(), ElementsAre("surface.spatial-variation")) << outcome.told();
  EXPECT_NEAR(outcome.fitted("x_m"), 0.03, 0.002);
  EXPECT_NEAR(outcome.fitted("y_m"), 0.14, 0.002);
  EXPECT_NEAR(outcome.fitted("width_m"), 0.02, 0.002);
  EXPECT_NEAR(outcome.fitted("depth"), -0.4, 0.03);
}

}  // namespace
}  // namespace gonio::tests
