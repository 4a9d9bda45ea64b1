// bench-plan [STEP_DEG [LAMP_PLACES]]: plans of two UR5 beside the naive plan, for `scripts/bench plan`.
//
// The naive plan takes the same views in the order asked and moves every arm straight in joint space to the inverse
// solution nearest to where it stands (largest joint step), the lamp's tool turned about its axis in one fixed way; it
// knows of limits and of nothing else. Both are walked by the same judge in steps of 1 mm, whose time knows joints'
// speeds and accelerations and the tools' speed limit.
#include "manifest/sections/plan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "acquisition/laboratories.h"
#include "acquisition/plan/candidates.h"
#include "acquisition/plan/configurations.h"
#include "acquisition/plan/planner.h"
#include "acquisition/plan/view_steps.h"
#include "base/parallel.h"
#include "geom/angle.h"
#include "robot/inverse/inverse_kinematics.h"
#include "robot/inverse/turns.h"

namespace gonio::acquisition {
namespace {

constexpr double radius_m = 0.3, step_m = 0.001, flip_rad = pi / 2;

struct Judged {
  double time_s = 0, clearance_m = 1e9, singular_m = 1e9, turn_rad = 0;
  std::size_t ways = 0, collisions = 0, singular = 0, other = 0, flips = 0;
};

Judged judged(const Laboratory& laboratory, const Surroundings& surroundings, const std::vector<Way>& ways) {
  std::vector<WayFigures> figures(ways.size());
  parallel_for(0, ways.size(), [&](std::size_t k) { figures[k] = judge(laboratory, surroundings, ways[k], step_m); });
  Judged sum;
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const WayFigures& f = figures[k];
    sum.time_s += f.duration_s, ++sum.ways;
    sum.clearance_m = std::min(sum.clearance_m, f.clearance_m);
    sum.singular_m = std::min(sum.singular_m, f.smallest_singular_m);
    double turn = 0;  // from view to view, whatever lies between
    for (const auto& [name, joints] : ways[k].front())
      for (std::size_t j = 0; j < joints.size(); ++j)
        turn = std::max(turn, std::abs(ways[k].back().at(name)[j] - joints[j]));
    if (k > 0) sum.turn_rad = std::max(sum.turn_rad, turn), sum.flips += turn > flip_rad;  // the first comes from home
    if (f.clearance_m <= laboratory.margin_m) ++sum.collisions;
    if (f.smallest_singular_m < laboratory.smallest_singular_m) ++sum.singular;
    if (!f.fault.empty() && f.clearance_m > laboratory.margin_m &&
        f.smallest_singular_m >= laboratory.smallest_singular_m)
      ++sum.other;
  }
  return sum;
}

// Joints of the nearest inverse solution; empty where there is none within the limits.
Joints nearest_solution(const LaboratoryArm& arm, const robot::InverseKinematics& inverse_kinematics,
                        const Rigid<frame::World, frame::Tool>& tool, const Joints& from) {
  robot::Joints near{};
  std::copy_n(from.begin(), near.size(), near.begin());
  Joints best;
  double least = 1e300;
  for (const auto& answer : inverse_kinematics.solve(inverse(arm.world_from_base) * tool, near)) {
    if (!answer.exact) continue;
    const auto turned = robot::with_turns(answer.joints_rad, near, arm.limits);
    if (!turned) continue;
    double turn = 0;
    for (std::size_t j = 0; j < near.size(); ++j) turn = std::max(turn, std::abs((*turned)[j] - near[j]));
    if (turn < least) least = turn, best.assign(turned->begin(), turned->end());
  }
  return best;
}

std::vector<Way> naive_ways(const manifest::Document& document, const Laboratory& laboratory,
                            const std::vector<manifest::PlanStep>& steps) {
  State at;
  std::map<std::string, robot::InverseKinematics> inverses;
  for (const auto& [name, arm] : laboratory.arms) at[name] = arm.home, inverses.try_emplace(name, arm.links, name);
  const Rigid<frame::Tool, frame::Camera> mount =
      inverse(world_from_tool(laboratory.arms.at("camera-arm"), at.at("camera-arm"))) *
      world_from_camera(document, laboratory, "eye", at);
  const Vec3 lamp_in_tool = inverse(world_from_tool(laboratory.arms.at("light-arm"), at.at("light-arm"))) *
                            lamp_position(document, laboratory, "led", at);
  std::vector<Way> ways;
  for (const manifest::PlanStep& step : steps) {
    State to = at;
    to["camera-arm"] = nearest_solution(laboratory.arms.at("camera-arm"), inverses.at("camera-arm"),
                                        *step.world_from_camera * inverse(mount), at.at("camera-arm"));
    const Vec3 place{step.light_m[0], step.light_m[1], step.light_m[2]};
    const Basis axes(normalized(Vec3{} - place));
    Mat3 rotation;
    for (int k = 0; k < 3; ++k) rotation(k, 0) = axes.t[k], rotation(k, 1) = axes.b[k], rotation(k, 2) = axes.n[k];
    to["light-arm"] = nearest_solution(laboratory.arms.at("light-arm"), inverses.at("light-arm"),
                                       {quaternion_of(rotation), place - rotation * lamp_in_tool}, at.at("light-arm"));
    for (auto& [name, joints] : to)
      if (joints.empty()) joints = at.at(name);  // it stays: no worse for the naive plan's time
    ways.push_back({at, to});
    at = to;
  }
  return ways;
}

// Where the plan's time is: in lines and detours; beside what no order of the same postures could go below, half of the
// sum of every stop's two shortest lines, whatever stands in their way.
void print_shares(const Laboratory& laboratory, const std::vector<Way>& ways) {
  double lines_s = 0, detours_s = 0, detours_as_lines_s = 0;
  std::size_t detours = 0;
  const Configurations configurations(laboratory);
  std::vector<Configurations::Placed> stops{configurations.placed(configurations.packed(ways.front().front()))};
  for (const Way& way : ways) {
    const double time_s = way_time(laboratory, way);
    stops.push_back(configurations.placed(configurations.packed(way.back())));
    (way.size() > 2 ? detours_s : lines_s) += time_s;
    if (way.size() > 2) ++detours, detours_as_lines_s += way_time(laboratory, {way.front(), way.back()});
  }
  std::vector<double> two_s(stops.size());
  parallel_for(0, stops.size(), [&](std::size_t k) {
    double first = 1e300, second = 1e300;
    for (std::size_t i = 0; i < stops.size(); ++i) {
      if (i == k) continue;
      const double time_s = configurations.time(stops[k], stops[i]);
      if (time_s < first)
        second = first, first = time_s;
      else
        second = std::min(second, time_s);
    }
    two_s[k] = (first + second) / 2;
  });
  double bound_s = 0;
  for (const double t : two_s) bound_s += t;
  std::printf(
      "  %.1f s in %zu lines, %.1f s in %zu detours (%.1f s as lines); no order of these postures below %.1f s\n",
      lines_s, ways.size() - detours, detours_s, detours, detours_as_lines_s, bound_s);
}

void print(const char* name, const Judged& j) {
  std::printf(
      "  %-7s %7.1f s of motion, %4zu ways: %3zu collide, %3zu singular, %3zu other faults, %3zu turn a joint "
      "by more than 90 deg; clearance %.4f m, smallest singular value %.4f m, largest joint step %.1f deg\n",
      name, j.time_s, j.ways, j.collisions, j.singular, j.other, j.flips, j.clearance_m, j.singular_m,
      j.turn_rad / degree);
}

void compare(const char* name, const manifest::Document& document, const Laboratory& laboratory,
             const std::vector<manifest::PlanStep>& asked) {
  const Surroundings surroundings(laboratory);
  const auto begun = std::chrono::steady_clock::now();
  const manifest::Plan plan = make_plan(document, laboratory, asked, name, {});
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  std::map<std::string, int> reasons;
  std::map<std::string, bool> missed;
  std::size_t near = 0;
  for (const auto& view : plan.unreachable) {
    ++reasons[view.why.substr(0, view.why.find_first_of("0123456789"))];
    missed[view.image] = true, near += view.nearest.has_value();
  }
  std::vector<manifest::PlanStep> same;
  for (const manifest::PlanStep& step : asked)
    if (!missed[step.image]) same.push_back(step);
  std::vector<Way> ways;
  for (std::size_t k = 0; k < plan.steps.size(); ++k) {
    Way way = way_to(laboratory, plan, k);
    if (way.size() > 1) ways.push_back(std::move(way));
  }
  const Judged own = judged(laboratory, surroundings, ways);
  const Judged naive = judged(laboratory, surroundings, naive_ways(document, laboratory, same));
  std::printf("%s: %zu views asked, %zu reached (%.1f %%), planned in %.1f s on %d threads, %.0f detours\n", name,
              asked.size(), plan.steps.size(), 100.0 * plan.steps.size() / asked.size(), took, threads(),
              plan.figures.at("detours"));
  print("plan", own), print_shares(laboratory, ways), print("naive", naive);
  std::printf("  time against the naive plan: %.3f (at most 0.7 asked)\n", own.time_s / naive.time_s);
  std::printf("  %zu unreachable, %zu of them with a near view that is reachable:\n", plan.unreachable.size(), near);
  for (const auto& [why, count] : reasons) std::printf("    %4d %s\n", count, why.c_str());
}

int run(int argc, char** argv) {
  const double step = (argc > 1 ? std::atof(argv[1]) : 10) * degree;
  const auto places = static_cast<std::size_t>(argc > 2 ? std::atoi(argv[2]) : 2);
  const manifest::Document document = tests::laboratory_document(tests::two_ur5_text());
  const Laboratory laboratory = believed_laboratory(document);
  PatternScene scene;
  scene.camera = "eye", scene.lamps = {"led"}, scene.exposures_s = {0.01};
  const ViewPattern& hemisphere = find_view_pattern("hemisphere", "bench");
  const auto views =
      hemisphere.make(scene, pattern_numbers(hemisphere, {{"radius", radius_m}, {"step", step}}, "bench"));
  // Lamps over the side of the arm that holds them.
  std::vector<manifest::PlanStep> camera_moves, lamp_moves;
  const auto add = [](std::vector<manifest::PlanStep>& to, manifest::PlanStep as, Vec3 light) {
    as.image = "view-" + std::to_string(to.size()), as.light_m = {light.x, light.y, light.z};
    to.push_back(std::move(as));
  };
  for (std::size_t p = 0; p < places; ++p) {
    const double azimuth = pi + (static_cast<double>(p) - 0.5 * static_cast<double>(places - 1)) * pi / 4;
    for (const auto& view : views) add(camera_moves, view, place_at(scene, {50 * degree, azimuth}, 0.4));
  }
  compare("camera over a hemisphere", document, laboratory, camera_moves);
  for (manifest::PlanStep& step : camera_moves) step.roll_rad = pi;
  compare("camera over a hemisphere, free to roll", document, laboratory, camera_moves);
  for (std::size_t p = 0; p < places; ++p) {
    manifest::PlanStep view = views.front();
    view.world_from_camera = camera_at(scene, {30 * degree, (p % 2 == 0 ? 0.5 : -0.5) * pi}, radius_m);
    for (const auto& at : views) add(lamp_moves, view, at.world_from_camera->translation_m);
  }
  compare("lamp over a hemisphere", document, laboratory, lamp_moves);
  return 0;
}

}  // namespace
}  // namespace gonio::acquisition

int main(int argc, char** argv) {
  return gonio::acquisition::run(argc, argv);
}
