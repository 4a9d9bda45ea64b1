// Plans for two UR5: they keep what was asked, every way can be walked, and what cannot be reached is said.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "acquisition/laboratories.h"
#include "acquisition/plan/planner.h"
#include "acquisition/plan/view_steps.h"
#include "base/error.h"
#include "base/parallel.h"
#include "geom/angle.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {
namespace {

PatternScene ur5_scene() {
  PatternScene scene;
  scene.camera = "eye", scene.lamps = {"led"}, scene.exposures_s = {0.01, 0.02};
  return scene;
}

std::vector<manifest::PlanStep> asked(const std::string& name, PatternNumbers given) {
  const ViewPattern& pattern = find_view_pattern(name, "--pattern");
  return pattern.make(ur5_scene(), pattern_numbers(pattern, given, "--pattern"));
}

struct Instrument {
  manifest::Document document = tests::laboratory_document(tests::two_ur5_text());
  Laboratory laboratory = believed_laboratory(document);
  Surroundings surroundings{laboratory};

  void expect_kept(const manifest::PlanStep& step, const State& state) const {
    if (step.world_from_camera) {
      const auto there = world_from_camera(document, laboratory, step.camera, state);
      EXPECT_LT(norm(there.translation_m - step.world_from_camera->translation_m), 1e-9) << step.image;
      EXPECT_LT(norm(rotation_vector_of(there.rotation * conjugate(step.world_from_camera->rotation))), 1e-9)
          << step.image;
    }
    if (step.light_m.empty()) return;
    const Vec3 lamp = lamp_position(document, laboratory, "led", state);
    EXPECT_LT(norm(lamp - Vec3{step.light_m[0], step.light_m[1], step.light_m[2]}), 1e-9) << step.image;
  }
  void expect_sound(const manifest::Plan& plan) const {
    std::set<std::string> images;
    for (std::size_t k = 0; k < plan.steps.size(); ++k) {
      EXPECT_TRUE(images.insert(plan.steps[k].image).second) << plan.steps[k].image;
      expect_kept(plan.steps[k], state_at(laboratory, plan, k));
      const Way way = way_to(laboratory, plan, k);
      if (way.size() < 2) continue;
      const WayFigures figures = judge(laboratory, surroundings, way, 0.01);
      EXPECT_EQ(figures.fault, "") << plan.steps[k].image;
      EXPECT_GE(figures.smallest_singular_m, laboratory.smallest_singular_m);
      EXPECT_GE(figures.clearance_m, laboratory.margin_m);
    }
  }
};

// Small enough for a test: a ring of views and one over the pole, the lamp in two places.
std::vector<manifest::PlanStep> few_views() {
  std::vector<manifest::PlanStep> steps =
      asked("hemisphere", {{"radius", 0.3}, {"step", 40 * degree}, {"lowest", 50 * degree}});
  for (std::size_t k = 0; k < steps.size(); ++k) steps[k].light_m = {-0.25, k % 2 == 0 ? 0.1 : -0.1, 0.35};
  return steps;
}

TEST(Plan, KeepsWhatWasAskedAndCanBeWalked) {
  const Instrument ur5;
  const auto steps = few_views();
  const manifest::Plan plan = make_plan(ur5.document, ur5.laboratory, steps, "few views", {});
  EXPECT_EQ(plan.steps.size() + plan.unreachable.size(), steps.size());
  EXPECT_GE(plan.steps.size(), steps.size() * 2 / 3);
  ur5.expect_sound(plan);
  EXPECT_EQ(plan.id, plan_id(ur5.document, plan));
  EXPECT_EQ(plan.id.size(), 64u);
  EXPECT_GT(plan.figures.at("moving_s"), 0);
  for (const manifest::PlanStep& step : plan.steps) EXPECT_EQ(step.robot, "camera-arm");
  // In the order asked it takes no less time, and the result does not depend on threads.
  const manifest::Plan slow = make_plan(ur5.document, ur5.laboratory, steps, "few views", {.keep_order = true});
  ur5.expect_sound(slow);
  EXPECT_LE(plan.figures.at("moving_s"), slow.figures.at("moving_s") * 1.02);
  for (std::size_t k = 1; k < slow.steps.size(); ++k) EXPECT_LT(slow.steps[k - 1].image, slow.steps[k].image);
  set_threads(1);
  const manifest::Plan again = make_plan(ur5.document, ur5.laboratory, steps, "few views", {});
  set_threads(0);
  EXPECT_EQ(again.id, plan.id);
}

TEST(Plan, SaysWhyAViewCannotBeReachedAndWhichNearOneCan) {
  const Instrument ur5;
  std::vector<manifest::PlanStep> steps = asked("photometric", {{"radius", 1.1}, {"elevation", 70 * degree}});
  steps.push_back(steps[0]);
  steps[1].image = "in-the-table", steps[1].world_from_camera->translation_m = {0.2, 0.2, -0.3};
  steps.push_back(steps[0]);
  steps[2].image = "lamp-too-far", steps[2].world_from_camera = {}, steps[2].light_m = {-0.5, 0, 1.3};
  const manifest::Plan plan = make_plan(ur5.document, ur5.laboratory, steps, "far", {});
  ASSERT_EQ(plan.unreachable.size(), 3u);
  EXPECT_NE(plan.unreachable[0].why.find("camera: "), std::string::npos) << plan.unreachable[0].why;
  EXPECT_NE(plan.unreachable[2].why.find("lamp: "), std::string::npos) << plan.unreachable[2].why;
  for (const manifest::UnreachableView& view : plan.unreachable) {
    EXPECT_FALSE(view.why.empty());
    if (!view.nearest) continue;
    State state{{"light-arm", view.nearest->other_arms.at("light-arm")}};
    if (!view.nearest->robot.empty()) state[view.nearest->robot] = view.nearest->joints_rad;
    ur5.expect_kept(*view.nearest, state);
    EXPECT_TRUE(ur5.surroundings.free(state, ur5.laboratory.margin_m)) << view.image;
  }
  ASSERT_TRUE(plan.unreachable[0].nearest);
  EXPECT_LT(norm(plan.unreachable[0].nearest->world_from_camera->translation_m), 1.1);
  steps = asked("photometric", {{"radius", 0.3}});
  steps[0].camera = "ear";
  EXPECT_THROW(make_plan(ur5.document, ur5.laboratory, steps, "", {}), Error);
  steps[0].camera = "eye", steps.push_back(steps[0]);
  EXPECT_THROW(make_plan(ur5.document, ur5.laboratory, steps, "", {}), Error);  // one id twice
}

TEST(Plan, InterleavesFramesThatTellDriftFromTheSurface) {
  const Instrument ur5;
  std::vector<manifest::PlanStep> steps =
      asked("octant", {{"radius", 0.3}, {"step", 20 * degree}, {"lowest", 50 * degree}});
  const std::size_t views = steps.size();
  for (const std::string purpose : {"reference", "board"}) {
    steps.push_back(steps[1]);
    steps.back().image = purpose, steps.back().purpose = purpose;
    steps.back().world_from_camera = camera_at(ur5_scene(), {purpose == "board" ? 0.2 : 0.4, 0.3}, 0.3);
  }
  const PlanOptions options{
      .seed = 3, .shuffle = true, .repeat_share = 0.25, .reference_every = 4, .board_every = 5, .dark_every = 3};
  const manifest::Plan plan = make_plan(ur5.document, ur5.laboratory, steps, "octant", options);
  ur5.expect_sound(plan);
  std::map<std::string, int> count;
  std::map<std::string, std::vector<double>> joints;  // of what is met again
  int since = 0;
  for (const manifest::PlanStep& step : plan.steps) {
    ++count[step.purpose];
    if (step.purpose == "reference") since = 0;
    if (step.purpose == "view" || step.purpose == "repeat") {
      EXPECT_LE(++since, 5) << step.image;
    }
    if (step.purpose == "dark") {
      EXPECT_TRUE(step.lamps.empty());
    }
    const std::string place = step.image.substr(0, step.image.find("-take-"));
    if (step.purpose == "dark") continue;
    const auto [at, first] = joints.try_emplace(place, step.joints_rad);
    if (!first) {
      EXPECT_EQ(at->second, step.joints_rad) << step.image;
    }
  }
  EXPECT_EQ(count["view"] + static_cast<int>(plan.unreachable.size()), static_cast<int>(views));
  EXPECT_EQ(count["repeat"], std::lround(0.25 * count["view"]));
  EXPECT_GE(count["reference"], 3);
  EXPECT_GE(count["board"], 3);
  EXPECT_GE(count["dark"], count["view"] / 3);
  PlanOptions other = options;
  other.seed = 4;
  const manifest::Plan shuffled = make_plan(ur5.document, ur5.laboratory, steps, "octant", other);
  EXPECT_NE(shuffled.id, plan.id);
  EXPECT_NE(shuffled.steps[3].image, plan.steps[3].image);
  steps.resize(views);
  EXPECT_THROW(make_plan(ur5.document, ur5.laboratory, steps, "octant", options), Error);  // no reference asked
}

TEST(Plan, StraightWaysStayOnTheirLine) {
  const Instrument ur5;
  const auto steps = asked("line", {{"views", 4}, {"distance", 0.3}, {"spread", 0.2}});
  const manifest::Plan plan = make_plan(ur5.document, ur5.laboratory, steps, "line", {.straight = "eye"});
  ASSERT_EQ(plan.steps.size(), 4u);
  ur5.expect_sound(plan);
  const LaboratoryArm& arm = ur5.laboratory.arms.at("camera-arm");
  for (std::size_t k = 1; k < plan.steps.size(); ++k) {
    ASSERT_TRUE(plan.steps[k].straight.value_or(false)) << k;
    const Way way = way_to(ur5.laboratory, plan, k);
    const Vec3 from = world_from_tool(arm, way.front().at("camera-arm")).translation_m;
    const Vec3 along = normalized(world_from_tool(arm, way.back().at("camera-arm")).translation_m - from);
    for (std::size_t s = 1; s < way.size(); ++s)
      for (const double share : {0.25, 0.5, 0.75, 1.0}) {
        Joints joints = way[s].at("camera-arm");
        const Joints& before = way[s - 1].at("camera-arm");
        for (std::size_t j = 0; j < joints.size(); ++j) joints[j] = before[j] + share * (joints[j] - before[j]);
        const Vec3 off = world_from_tool(arm, joints).translation_m - from;
        EXPECT_LT(norm(off - along * dot(off, along)), 1e-4) << k << " " << s;
      }
  }
}

TEST(Plan, TheIdHashesWhatDecidesAndNothingElse) {
  Instrument ur5;
  const auto steps = asked("photometric", {{"radius", 0.3}});
  const manifest::Plan plan = make_plan(ur5.document, ur5.laboratory, steps, "one", {});
  ASSERT_EQ(plan.steps.size(), 1u);
  const auto changed = [&](auto change) {
    manifest::Plan other = plan;
    change(other);
    return plan_id(ur5.document, other) != plan.id;
  };
  EXPECT_TRUE(changed([](manifest::Plan& p) { p.steps[0].joints_rad[2] += 1e-12; }));
  EXPECT_TRUE(changed([](manifest::Plan& p) { p.steps[0].exposures_s[0] = 0.011; }));
  EXPECT_TRUE(changed([](manifest::Plan& p) { p.steps[0].lamps.clear(); }));
  EXPECT_TRUE(changed([](manifest::Plan& p) { p.seed = 2; }));
  EXPECT_TRUE(changed([](manifest::Plan& p) { p.pattern = "two"; }));
  EXPECT_FALSE(changed([](manifest::Plan& p) { p.steps[0].duration_s = 7; }));
  EXPECT_FALSE(changed([](manifest::Plan& p) { p.figures["moving_s"] = 7; }));
  EXPECT_FALSE(changed([](manifest::Plan& p) { p.id = "x"; }));
  const auto changed_laboratory = [&](auto change) {
    manifest::Document other = ur5.document;
    change(other.laboratory.entry.front());
    return plan_id(other, plan) != plan.id;
  };
  using L = manifest::Laboratory;
  EXPECT_TRUE(changed_laboratory([](L& l) { l.obstacles.pop_back(); }));
  EXPECT_TRUE(changed_laboratory([](L& l) { l.robots.at("light-arm").world_from_base->translation_m.x += 1e-6; }));
  EXPECT_TRUE(changed_laboratory([](L& l) { l.limits->margin_m = 0.02; }));
  EXPECT_FALSE(changed_laboratory([](L& l) { l.robots.at("light-arm").url = "modbus://10.0.0.7:502"; }));
  EXPECT_FALSE(changed_laboratory([](L& l) { l.cameras.at("eye").tool_from_camera->translation_m.z += 1e-3; }));
}

}  // namespace
}  // namespace gonio::acquisition
