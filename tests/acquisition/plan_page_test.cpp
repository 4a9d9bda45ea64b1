// The pages of a laboratory and a plan, the model that moves on them, and the triangles that solids are drawn with.
#include "acquisition/plan/plan_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "acquisition/laboratories.h"
#include "acquisition/motion/body.h"
#include "acquisition/plan/drawn_shapes.h"
#include "acquisition/plan/planner.h"
#include "acquisition/plan/solid_mesh.h"
#include "acquisition/plan/view_steps.h"
#include "base/random.h"
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

manifest::Plan small_plan(const manifest::Document& document, const Laboratory& laboratory) {
  PatternScene scene;
  scene.camera = "eye", scene.lamps = {"led"};
  const ViewPattern& pattern = find_view_pattern("hemisphere", "--pattern");
  auto steps = pattern.make(
      scene, pattern_numbers(pattern, {{"radius", 0.3}, {"step", 45 * degree}, {"lowest", 45 * degree}}, ""));
  steps.push_back(steps[0]);
  steps.back().image = "beyond", steps.back().world_from_camera = camera_at(scene, {0.3, 0}, 3);
  return make_plan(document, laboratory, steps, "a few & one beyond", {});
}

// Largest difference of where the model's nodes and the collision checker's bodies stand, m and columns of rotations.
double model_error(const LaboratoryModel& lab, const Laboratory& laboratory, const State& state, double time_s) {
  const std::vector<Body> bodies = bodies_of(laboratory);
  const std::vector<PlacedBody> expected = placed(laboratory, bodies, state);
  const std::vector<io::PlacedNode> at = io::placed_nodes(lab.model, time_s);
  double worst = lab.solids.size() == bodies.size() ? 0 : 1e9;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const io::PlacedNode& node = at[static_cast<std::size_t>(lab.solids[b])];
    worst = std::max(worst, norm(node.origin_m - expected[b].origin_m));
    for (std::size_t k = 0; k < 9; ++k)
      worst = std::max(worst, std::abs(node.rotation.m[k] - expected[b].rotation.m[k]));
  }
  return worst;
}

TEST(PlanPage, TheModelStandsWhereTheCollisionCheckerHasItsBodies) {
  for (const std::string& text : {tests::two_ur5_text(), tests::abb_and_arc_text(), tests::ur3_and_turntable_text()}) {
    const manifest::Document document = tests::laboratory_document(text);
    const Laboratory laboratory = believed_laboratory(document);
    LaboratoryModel lab = laboratory_model(document, laboratory);
    EXPECT_LT(model_error(lab, laboratory, {}, 0), 1e-12);
    Random random(4, 7);
    for (int k = 0; k < 20; ++k) {
      State state;
      for (const auto& [name, arm] : laboratory.arms)
        for (std::size_t j = 0; j < arm.links.size(); ++j) state[name].push_back(random.uniform(-6, 6));
      lab.model.keys = {{0, hinge_angles(document, laboratory, state, {{"turntable", 2}})}};
      EXPECT_LT(model_error(lab, laboratory, state, 0), 1e-12);
    }
  }
}

// A calibrated arm's frames lie far away; what is handed on in single precision must not.
TEST(PlanPage, ACalibratedArmIsHandedOnFromNearby) {
  manifest::Document document = tests::laboratory_document(tests::two_ur5_text());
  Laboratory laboratory = believed_laboratory(document);
  robot::Link *second = &laboratory.arms.at("camera-arm").links[1], *third = second + 1;
  second->d_m += 487, third->d_m -= 487;  // along axes that are parallel
  const LaboratoryModel lab = laboratory_model(document, laboratory);
  EXPECT_LT(model_error(lab, laboratory, {}, 0), 1e-9);
  for (const io::ModelNode& node : lab.model.nodes)
    EXPECT_TRUE(node.hinge < 0 || norm(node.placed.translation_m) < 1) << node.name;
}

TEST(PlanPage, TimeRunsThroughMotionsAndPhotographs) {
  const manifest::Document document = tests::laboratory_document(tests::two_ur5_text());
  const Laboratory laboratory = believed_laboratory(document);
  const manifest::Plan plan = small_plan(document, laboratory);
  const PlanTimes times = times_of(document, laboratory, plan);
  double moving = 0, before = -1;
  for (const manifest::PlanStep& step : plan.steps) moving += step.duration_s.value_or(0);
  for (const PlanMoment& moment : times.moments) {
    EXPECT_GT(moment.time_s, before);
    before = moment.time_s;
  }
  // One exposure of 10 ms at each, and the lamp's 20 ms.
  EXPECT_NEAR(times.end_s(), moving + 0.03 * static_cast<double>(plan.steps.size()), 1e-9);
  const LaboratoryModel lab = plan_model(document, laboratory, plan, times);
  ASSERT_EQ(times.stands.size(), plan.steps.size());
  for (std::size_t k = 0; k < plan.steps.size(); ++k) {
    const double middle = (times.stands[k].from_s + times.stands[k].until_s) / 2;
    EXPECT_LT(model_error(lab, laboratory, state_at(laboratory, plan, k), middle), 1e-12);
    const auto& eye = lab.model.nodes[static_cast<std::size_t>(lab.lamps.at("led"))];
    EXPECT_EQ(io::colour_at(eye, middle), static_cast<int>(Tint::lit));
  }
  for (int k = 0; k < 40; ++k) {  // on the ways, too
    const double t = times.end_s() * k / 39;
    EXPECT_LT(model_error(lab, laboratory, state_at_time(laboratory, times, t), t), 1e-12);
  }
}

TEST(PlanPage, ViewsAreMarkedWhereTheyAreTakenAndWhereTheyCannotBe) {
  const manifest::Document document = tests::laboratory_document(tests::two_ur5_text());
  const Laboratory laboratory = believed_laboratory(document);
  const manifest::Plan plan = small_plan(document, laboratory);
  ASSERT_GE(plan.unreachable.size(), 1U);
  const PlanTimes times = times_of(document, laboratory, plan);
  const auto marks = [](const LaboratoryModel& lab, double time_s, Tint tint) {
    return std::ranges::count_if(lab.model.nodes, [&](const io::ModelNode& n) {
      return n.mesh >= 0 && io::colour_at(n, time_s) == static_cast<int>(tint);
    });
  };
  const LaboratoryModel lab = plan_model(document, laboratory, plan, times);
  const auto views = static_cast<std::ptrdiff_t>(plan.steps.size());
  EXPECT_EQ(marks(lab, 0, Tint::to_take), views);
  EXPECT_EQ(marks(lab, times.stands[1].until_s, Tint::taken), 2);
  EXPECT_EQ(marks(lab, times.end_s(), Tint::taken), views);
  EXPECT_EQ(marks(lab, 0, Tint::unreachable), static_cast<std::ptrdiff_t>(plan.unreachable.size()));
  const std::set<std::size_t> taken{0, 3};
  EXPECT_EQ(marks(plan_model(document, laboratory, plan, times, &taken), 0, Tint::taken), 2);
  const auto missed = std::ranges::find(lab.model.nodes, "beyond", &io::ModelNode::name);
  ASSERT_NE(missed, lab.model.nodes.end());
  EXPECT_GT(norm(missed->placed.translation_m), 2.5);  // asked from three metres away
}

// A scanned obstacle of a hundred thousand triangles: no page needs them.
TEST(PlanPage, LargeMeshesAreDrawnCoarsely) {
  Solid wavy;
  wavy.shape = Solid::Shape::mesh;
  constexpr std::uint32_t n = 220;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j)
      wavy.vertices_m.push_back({i / double{n}, j / double{n}, 0.05 * std::sin(0.06 * i) * std::cos(0.05 * j)});
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      wavy.triangles.push_back({a, b, b + 1}), wavy.triangles.push_back({a, b + 1, a + 1});
    }
  const io::TriangleMesh drawn = drawn_solid(wavy);
  EXPECT_LE(drawn.triangles.size(), most_drawn_triangles);
  EXPECT_GT(drawn.triangles.size(), most_drawn_triangles / 4);
  double area = 0;
  for (const auto& t : drawn.triangles) {
    const Vec3 a = drawn.positions_m.at(t[0]);
    area += std::abs(cross(drawn.positions_m.at(t[1]) - a, drawn.positions_m.at(t[2]) - a).z) / 2;
  }
  EXPECT_NEAR(area, 1, 0.1);  // seen from above it still covers its square
  wavy.triangles.resize(100);
  EXPECT_EQ(drawn_solid(wavy).triangles, wavy.triangles);
}

TEST(PlanPage, ShowsWhatThePlanSays) {
  const manifest::Document document = tests::laboratory_document(tests::two_ur5_text());
  const Laboratory laboratory = believed_laboratory(document);
  const manifest::Plan plan = small_plan(document, laboratory);
  const std::string page = plan_page(document, laboratory, plan);
  for (const std::string& said :
       {plan.id, std::string("class=\"solid\""), std::string("a few &amp; one beyond"), std::string("beyond"),
        std::string("joint 6"), std::string("out of reach of"), std::string("view out of reach"),
        std::string("data-time="), std::string("makeTimeline")})
    EXPECT_NE(page.find(said), std::string::npos) << said;
  EXPECT_LT(page.size(), 1u << 20);
}

TEST(PlanPage, TheLaboratoryIsDrawnWithoutAPlan) {
  const manifest::Document document = tests::laboratory_document(tests::ur3_and_turntable_text());
  const Laboratory laboratory = believed_laboratory(document);
  const std::string page = laboratory_page(document, laboratory);
  for (const std::string& said :
       {std::string("1 arm, 2 cameras, 0 lamps"), std::string("\"moving\""), std::string("\"standing\""),
        std::string("\"lcd\""), std::string("\"turntable\""), std::string("its lens is not described"),
        std::string("0.000, -0.020, 0.900"), std::string("what a camera sees")})
    EXPECT_NE(page.find(said), std::string::npos) << said;
  EXPECT_EQ(page.find("http:"), std::string::npos);
  EXPECT_EQ(page.find("view to be taken"), std::string::npos);
}

}  // namespace
}  // namespace gonio::acquisition
