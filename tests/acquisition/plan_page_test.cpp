// The page of a plan, and the triangles that its solids are drawn with.
#include "acquisition/plan/plan_page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "acquisition/laboratories.h"
#include "acquisition/plan/planner.h"
#include "acquisition/plan/solid_mesh.h"
#include "acquisition/plan/view_steps.h"
#include "geom/angle.h"

namespace gonio::acquisition {
namespace {

// Closed, turned outwards, and as large as the solid less its facets' shortfall.
TEST(PlanPage, SolidsAreDrawnClosedAndTurnedOutwards) {
  const std::map<Solid::Shape, double> volumes{{Solid::Shape::box, 0.2 * 0.3 * 0.4},
                                               {Solid::Shape::cylinder, pi * 0.2 * 0.2 * 0.3},
                                               {Solid::Shape::ball, 4.0 / 3 * pi * 0.2 * 0.2 * 0.2}};
  for (const auto& [shape, expected] : volumes) {
    Solid solid;
    solid.shape = shape, solid.sides_m = {0.2, 0.3, 0.4};
    const SolidMesh mesh = mesh_of(solid);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double volume = 0;
    for (const auto& t : mesh.triangles) {
      volume += dot(mesh.vertices_m[t[0]], cross(mesh.vertices_m[t[1]], mesh.vertices_m[t[2]])) / 6;
      for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    }
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      EXPECT_TRUE(edges.contains({edge.second, edge.first}));
    }
    EXPECT_LT(volume, expected * (1 + 1e-12));
    EXPECT_GT(volume, expected * 0.95);
  }
}

TEST(PlanPage, ShowsWhatThePlanSays) {
  const manifest::Document document = tests::laboratory_document(tests::two_ur5_text());
  const Laboratory laboratory = believed_laboratory(document);
  PatternScene scene;
  scene.camera = "eye", scene.lamps = {"led"};
  const ViewPattern& pattern = find_view_pattern("hemisphere", "--pattern");
  auto steps = pattern.make(
      scene, pattern_numbers(pattern, {{"radius", 0.3}, {"step", 45 * degree}, {"lowest", 45 * degree}}, ""));
  steps.push_back(steps[0]);
  steps.back().image = "beyond", steps.back().world_from_camera = camera_at(scene, {0.3, 0}, 3);
  const manifest::Plan plan = make_plan(document, laboratory, steps, "a few & one beyond", {});
  const std::string page = plan_page(laboratory, plan);
  for (const std::string& said : {plan.id, std::string("class=\"solid\""), std::string("a few &amp; one beyond"),
                                  std::string("beyond"), std::string("joint 6"), std::string("out of reach of")})
    EXPECT_NE(page.find(said), std::string::npos) << said;
  EXPECT_LT(page.size(), 8u << 20);
}

}  // namespace
}  // namespace gonio::acquisition
