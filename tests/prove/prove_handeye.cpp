// scripts/proofs/handeye-coverage: simulated calibrations with known truth; do intervals of 95 % cover it, is the joint
// refinement better than the closed forms, are outliers found and false alarms rare?
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "robot/handeye/closed_forms.h"
#include "robot/handeye/consensus.h"
#include "robot/handeye_world.h"
#include "robot/light_handeye.h"

namespace gonio::prove {
namespace {

namespace he = robot::handeye;
using tests::HandEyeWorld;

bool within(const char* name, double measured, double lower, double upper) {
  const bool passed = measured >= lower && measured <= upper;
  std::printf("%s: measured %.4f required %.4f .. %.4f%s\n", name, measured, lower, upper, passed ? "" : "  FAILED");
  return passed;
}

bool coverage(const char* name, const HandEyeWorld& world, int runs, int outliers) {
  int covered = 0, all = 0, alarms = 0, alarmed_runs = 0, found = 0;
  double joint = 0, park = 0;
  for (int run = 0; run < runs; ++run) {
    auto views = world.views(40000 + static_cast<std::uint64_t>(run));
    for (int k = 0; k < outliers; ++k)
      views[static_cast<std::size_t>(3 * k)].base_from_tool.translation_m += Vec3{0.008, -0.006, 0.005};
    const he::Consensus c = he::find_consensus(world.setup(), views);
    const int alarms_before = alarms;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (c.counts[i]) continue;
      const bool wrong = i % 3 == 0 && static_cast<int>(i / 3) < outliers;
      ++(wrong ? found : alarms);
    }
    alarmed_runs += alarms > alarms_before;
    const he::Solution& s = c.refined.solution;
    auto e = tests::error_of(s.mount_from_camera, world.truth.mount_from_camera);
    const auto z = tests::error_of(s.stand_from_board, world.truth.stand_from_board);
    e.insert(e.end(), z.begin(), z.end());
    for (std::size_t k = 0; k < 12; ++k) covered += std::abs(e[k]) <= 1.96 * c.refined.sigma(k);
    all += 12;
    const he::Solution p = he::closed_form("park", "").solve(he::samples_of(world.setup(), views));
    joint += std::pow(norm(s.mount_from_camera.translation_m - world.truth.mount_from_camera.translation_m), 2);
    park += std::pow(norm(p.mount_from_camera.translation_m - world.truth.mount_from_camera.translation_m), 2);
  }
  std::printf(
      "%s: %d runs, camera's place off by %.3f mm (park %.3f mm), outliers found %d of %d, false alarms %d of %d "
      "poses\n",
      name, runs, std::sqrt(joint / runs) * 1e3, std::sqrt(park / runs) * 1e3, found, outliers * runs, alarms,
      (world.poses - outliers) * runs);
  bool passed = within(name, static_cast<double>(covered) / all, 0.93, 0.97);
  passed = within("  joint over park", std::sqrt(joint / park), 0, 1) && passed;
  passed = within("  runs with a false alarm, at most", static_cast<double>(alarmed_runs) / runs, 0, 0.05) && passed;
  return passed &&
         (outliers == 0 || within("  outliers found", static_cast<double>(found) / (outliers * runs), 0.95, 1));
}

bool light_coverage(int runs) {
  const Rigid<frame::World, frame::Base> base{normalized(Quaternion{0.7, 0.1, -0.2, 0.6}), {0.8, -0.3, 0.4}};
  const Vec3 light{0.03, -0.02, 0.15};
  int covered = 0, all = 0;
  for (int run = 0; run < runs; ++run) {
    Random random(static_cast<std::uint64_t>(run), 11);
    std::vector<robot::LightSample> samples;
    for (int i = 0; i < 15; ++i) {
      const Vec3 turn{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-2, 2)};
      const Rigid<frame::Base, frame::Tool> tool{
          quaternion_of_rotation_vector(turn),
          {random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), random.uniform(0.1, 0.6)}};
      const Vec3 noise = Vec3{random.normal(), random.normal(), random.normal()} * std::hypot(0.002, 0.001);
      samples.push_back({"p", tool, base * (tool * light) + noise, {0.001, 0.001, 0.001}});
    }
    const robot::LightMounting m = robot::calibrate_light(samples);
    const auto pose = tests::error_of(m.world_from_base, base);
    const Vec3 l = m.light_in_tool_m - light;
    const std::array<double, 9> e{pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], l.x, l.y, l.z};
    for (std::size_t k = 0; k < 9; ++k) covered += std::abs(e[k]) <= 1.96 * m.sigma(k);
    all += 9;
  }
  return within("light in hand", static_cast<double>(covered) / all, 0.93, 0.97);
}

}  // namespace
}  // namespace gonio::prove

int main(int argc, char** argv) {
  using namespace gonio;
  const int runs = argc > 1 ? std::atoi(argv[1]) : 500;
  tests::HandEyeWorld in_hand, to_hand, few, camera;
  in_hand.poses = 20;
  to_hand.poses = 20;
  to_hand.kind = robot::handeye::Kind::eye_to_hand;
  few.poses = 8;
  camera.poses = 20;
  camera.corner_px = 0.5;
  camera.robot_m = 0.0001;
  camera.robot_rad = 0.0001;
  bool passed = prove::coverage("eye-in-hand, 20 poses", in_hand, runs, 0);
  passed = prove::coverage("eye-to-hand, 20 poses", to_hand, runs, 0) && passed;
  passed = prove::coverage("eye-in-hand, 8 poses", few, runs, 0) && passed;
  passed = prove::coverage("noisy camera, good robot", camera, runs, 0) && passed;
  passed = prove::coverage("eye-in-hand, 20 poses, 3 wrong", in_hand, runs, 3) && passed;
  passed = prove::light_coverage(runs) && passed;
  return passed ? 0 : 1;
}
