// Terms of pictures one by one, each in play alone: their derivatives are the differences of whole predictions, and at
// their neutral values not a bit is changed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "effect_world.h"
#include "manifest/document.h"

namespace gonio::tests {
namespace {

using explain::images::ImagesProblem;

// Everything that the new terms act on: gloss, lamps of two colours, several views, highlights that are cut off.
EffectWorld full_world() {
  EffectWorld world;
  world.views = 2;
  world.spp = 16;
  world.ball = R"({"model":"coated-diffuse","albedo":{"value":[0.5,0.4,0.3],"free":true},"f0":0.05,"alpha":0.3})";
  world.lights = {R"({"model":"point","position_m":[0.3,-0.3,0.4],"watt_per_sr":[0.7,0.6,0.3]})",
                  R"({"model":"point","position_m":[-0.35,-0.1,0.45],"watt_per_sr":[0.4,0.5,0.9]})"};
  world.noise = 1e-4;
  world.change = [](std::size_t, std::size_t, io::Image& picture) {
    for (float& v : picture.data) v = std::min(v, 0.25f);
  };
  return world;
}

void check(const ImagesProblem& problem, const std::set<std::string>& ids) {
  std::vector<double> neutral;
  for (const explain::Parameter& p : problem.parameters()) neutral.push_back(p.neutral);
  const std::size_t rows = problem.observations().first[1];
  std::vector<double> plain(rows), with(rows);
  problem.predict(neutral, 0, plain);
  std::set<std::string> seen;
  for (const explain::Candidate& c : problem.candidates()) {
    if (!ids.contains(c.id())) continue;
    seen.insert(c.id());
    std::vector<double> values = neutral;
    for (const std::size_t p : c.parameters)
      values[p] = problem.parameters()[p].start + 0.01 * problem.parameters()[p].size;
    problem.predict(values, 0, with);
    EXPECT_NE(with, plain) << c.id();
    std::vector<double> kept(rows * c.parameters.size()), whole(kept.size());
    problem.jacobian(values, 0, c.parameters, kept);
    problem.Problem::jacobian(values, 0, c.parameters, whole);
    double largest = 0;
    for (const double v : whole) largest = std::max(largest, std::abs(v));
    EXPECT_GT(largest, 0) << c.id();
    for (std::size_t i = 0; i < kept.size(); ++i)
      ASSERT_NEAR(kept[i], whole[i], 1e-6 * largest) << problem.parameters()[c.parameters[i / rows]].name;
    for (const std::size_t p : c.parameters) values[p] = neutral[p];
    problem.predict(values, 0, with);
    EXPECT_EQ(with, plain) << c.id();
  }
  EXPECT_EQ(seen, ids);
}

TEST(Derivatives, AreDifferencesOfPredictions) {
  const ScratchFolder folder;
  const ImagesProblem problem(full_world().record(folder), {.pixels = 800});
  check(problem, {"optics.defocus", "sensor.prnu", "light.polarization", "surface.anisotropy", "surface.fluorescence",
                  "sensor.clipped-resampling"});
}

TEST(Derivatives, OfSurroundingsAndCaustics) {
  EffectWorld world;
  world.views = 1;
  world.spp = 4;
  world.more_meshes = R"(,"bead":{"sphere":{"radius_m":0.03}})";
  world.more_surfaces = R"(,"glass":{"model":"dielectric","eta":1.3})";
  world.more_objects = R"(,{"id":"bead","mesh":"bead","surface":"glass","world_from_object":{"rotation":[1,0,0,0],)"
                       R"("translation_m":[0.05,0.12,0.06]}})";
  world.lights_together = true;
  for (const char* towards : {"[1,0,0.6]", "[-0.6,0.9,0.5]", "[-0.3,-0.8,0.7]"})
    world.lights.push_back(std::string(R"({"model":"directional","towards":)") + towards +
                           R"(,"watt_per_m2":[0.8,0.8,0.8]})");
  const ScratchFolder folder;
  const ImagesProblem problem(world.record(folder), {.pixels = 600});
  check(problem, {"light.near-environment", "transport.caustic"});
}

}  // namespace
}  // namespace gonio::tests
