// scripts/proofs/robot-explain: sealed hand-eye cells (tests/explain/robot/robot_world.cpp: an arm by products of
// exponentials) and one table of what explain finds, names, how much it says, whether its intervals cover, and how
// often it is wrong.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>

#include "explain/engine.h"
#include "explain/robot/robot_problem.h"
#include "explain/robot/robot_world.h"
#include "manifest/document.h"
#include "stats/intervals.h"

namespace gonio::prove {
namespace {

using namespace gonio::explain;
using tests::CellTruth;

struct Kind {
  const char* name;
  const char* effect;  // nullptr: nothing is wrong
  CellTruth (*truth)(std::uint64_t seed);
  int repeats;  // times the argument
};

CellTruth sound(std::uint64_t seed) {
  CellTruth truth;
  truth.robot_shift_m = 5e-5 * static_cast<double>(1 + seed % 10);
  truth.robot_turn_rad = 5e-5 * static_cast<double>(1 + seed % 7);
  truth.corner_px = 0.05 * static_cast<double>(1 + seed % 4);
  return truth;
}
CellTruth turned(std::uint64_t seed) {
  CellTruth truth;
  const double off = 0.05 * pi / 180;
  const auto sign = [&](int bit) { return (seed >> bit) & 1 ? off : -off; };
  truth.joint_offset_rad = {0, sign(0), sign(1), sign(2), sign(3), 0};
  return truth;
}
CellTruth hanging(std::uint64_t) {
  CellTruth truth;
  truth.sag_rad_per_m = 1e-3;
  return truth;
}
CellTruth longer(std::uint64_t) {
  CellTruth truth;
  truth.longer_upper_arm_m = 1e-3;
  return truth;
}
CellTruth stretched(std::uint64_t) {
  CellTruth truth;
  truth.board_stretch = 0.005;
  return truth;
}

CellTruth loose(std::uint64_t) {
  CellTruth truth;
  truth.backlash_rad = {0, 8e-4, 7e-4, 0, 0, 0};
  return truth;
}
CellTruth warming(std::uint64_t) {
  CellTruth truth;
  truth.growth_per_K = 2.5e-5;
  truth.warming_K = 20;
  return truth;
}
CellTruth late(std::uint64_t) {
  CellTruth truth;
  truth.in_motion = true;
  truth.lag_s = 4e-3;
  return truth;
}

std::optional<double> true_value(const CellTruth& t, const std::string& parameter) {
  const auto joint = [&](std::size_t at) { return t.joint_offset_rad[static_cast<std::size_t>(parameter[at] - '1')]; };
  if (parameter.starts_with("robot.joint-offset.joint_")) return joint(25);
  if (parameter.starts_with("robot.sag.")) return t.sag_rad_per_m;
  if (parameter == "robot.link-length.a_2_m") return -t.longer_upper_arm_m;
  if (parameter.starts_with("robot.link-length.")) return 0.0;
  if (parameter.starts_with("board.scale.")) return t.board_stretch;
  if (parameter.starts_with("robot.backlash.backlash_"))
    return t.backlash_rad[static_cast<std::size_t>(parameter[24] - '1')];
  if (parameter == "robot.thermal.growth_per_K") return t.growth_per_K;
  if (parameter == "robot.time-offset.lag_s") return t.lag_s;
  return std::nullopt;
}

struct Row {
  int cases = 0, found = 0, exact = 0, reported = 0, wrong = 0, unknown = 0, intervals = 0, covered = 0;
};

void enter(const Kind& kind, const CellTruth& truth, std::uint64_t seed, Row& row) {
  const auto problem = robot_problem(robot_inputs(tests::robot_cell(truth, 40, seed)).at(0));
  const Explanation e = explain::explain(*problem, {});
  const auto id = [&](std::size_t c) { return problem->candidates()[c].id(); };
  const std::string effect = kind.effect == nullptr ? "" : kind.effect;
  ++row.cases;
  row.found += e.verdict != Verdict::null;
  row.unknown += e.verdict == Verdict::unknown;
  row.exact += e.named.size() == 1 && id(e.named[0]) == effect;
  row.wrong += std::any_of(e.named.begin(), e.named.end(), [&](std::size_t c) { return id(c) != effect; });
  bool reported = std::any_of(e.named.begin(), e.named.end(), [&](std::size_t c) { return id(c) == effect; });
  for (const auto& set : e.not_told_apart)
    reported = reported || std::any_of(set.begin(), set.end(), [&](std::size_t c) { return id(c) == effect; });
  row.reported += reported;
  for (const Estimate& estimate : e.estimates) {
    const std::string& name = problem->parameters()[estimate.parameter].name;
    const std::optional<double> truly = true_value(truth, name);
    if (!name.starts_with(effect + ".") || !truly) continue;
    ++row.intervals;
    row.covered += estimate.lower_95 <= *truly && *truly <= estimate.upper_95;
  }
}

bool print_claim(const std::string& name, int successes, int trials, double required, bool at_most) {
  const double share = trials > 0 ? static_cast<double>(successes) / trials : 0;
  const bool met = at_most ? share <= required : share >= required;
  std::printf("robot-explain %s: measured %d of %d (%.1f %%) required %s %.0f %%%s\n", name.c_str(), successes, trials,
              100 * share, at_most ? "<=" : ">=", 100 * required, met ? "" : "  NOT MET");
  return met;
}

int prove(int repeats) {
  const Kind kinds[] = {{"nothing wrong", nullptr, sound, 40},
                        {"joint zeros off by 0.05 degrees", "robot.joint-offset", turned, 16},
                        {"sag of 1 mrad per metre", "robot.sag", hanging, 8},
                        {"upper arm longer by 1 mm", "robot.link-length", longer, 8},
                        {"board larger by 0.5 %", "board.scale", stretched, 8},
                        {"play of 0.8 and 0.7 mrad", "robot.backlash", loose, 4},
                        {"growth of 25 ppm / K over 20 K", "robot.thermal", warming, 4},
                        {"poses 4 ms late", "robot.time-offset", late, 4}};
  std::printf("%-34s %5s %6s %6s %9s %6s %8s %9s\n", "effect", "cases", "found", "named", "in answer", "wrong",
              "unknown", "coverage");
  bool met = true;
  Row present;
  for (const Kind& kind : kinds) {
    Row row;
    for (int k = 0; k < kind.repeats * repeats; ++k) {
      const auto seed = static_cast<std::uint64_t>(1000 + k);
      enter(kind, kind.truth(seed), seed, row);
    }
    std::printf("%-34s %5d %6d %6d %9d %6d %8d %5d/%d\n", kind.name, row.cases, row.found, row.exact, row.reported,
                row.wrong, row.unknown, row.covered, row.intervals);
    std::fflush(stdout);
    if (kind.effect == nullptr) {
      met &= print_claim("nothing wrong, named", row.wrong, row.cases, 0.05, true);
      continue;
    }
    met &= print_claim(std::string(kind.name) + ", in the answer", row.reported, row.cases, 0.9, false);
    present.intervals += row.intervals, present.covered += row.covered;
  }
  met &= print_claim("95 % intervals cover", present.covered, present.intervals, 0.9, false);
  return met ? 0 : 1;
}

}  // namespace
}  // namespace gonio::prove

int main(int argc, char** argv) {
  return gonio::prove::prove(argc > 1 ? std::max(1, std::atoi(argv[1])) : 5);
}
