// Test vectors of the authors of the method: https://github.com/rpiRobotics/ik-geo, test_cases. Subproblems: the angles
// that made them are among the answers. Robots, by axes and offsets: rows are made of them, and the generating joints
// are among the answers, which all reach the pose.
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "data.h"
#include "inverse_world.h"
#include "robot/axis_rows.h"
#include "robot/inverse/screws.h"
#include "robot/inverse/subproblems.h"

namespace gonio::robot {
namespace {

using namespace inverse_world;
using namespace subproblem;

std::vector<std::vector<double>> vectors_of(const char* name) {
  std::ifstream file(tests::data("robots/ik-geo") / name);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  EXPECT_EQ(rows.size(), 10u) << name;
  return rows;
}

struct Row {
  const std::vector<double>& cells;
  double number(std::size_t i) const { return cells.at(i); }
  Vec3 vec(std::size_t nth) const { return {cells.at(3 * nth), cells.at(3 * nth + 1), cells.at(3 * nth + 2)}; }
};

double off(double a, double b) {
  return std::abs(std::remainder(a - b, 2 * pi));
}

constexpr double close_rad = 1e-9;

TEST(IkGeoVectors, SubproblemsOfOneTurn) {
  GONIO_NEEDS_DATA("robots/ik-geo");
  for (const auto& cells : vectors_of("sp_1.csv")) {
    const Row r{cells};
    EXPECT_LT(off(sp1(r.vec(0), r.vec(2), r.vec(1)).angle_rad, r.number(9)), close_rad);
  }
  const auto expect_one = [](const TwoTurns& t, double angle) {
    EXPECT_LT(std::min(off(t.falling_rad, angle), off(t.rising_rad, angle)), 1e-7);
  };
  for (const auto& cells : vectors_of("sp_3.csv")) {
    const Row r{cells};
    expect_one(sp3(r.vec(0), r.vec(1), r.vec(2), r.number(9)), r.number(10));
  }
  for (const auto& cells : vectors_of("sp_4.csv")) {
    const Row r{cells};
    expect_one(sp4(r.vec(2), r.vec(0), r.vec(1), r.number(9)), r.number(10));
  }
}

template <class Pairs>
void expect_pair(const Pairs& pairs, double first, double second) {
  double best = 10;
  for (const Pair& p : pairs) best = std::min(best, std::max(off(p.first_rad, first), off(p.second_rad, second)));
  EXPECT_LT(best, 1e-7);
}

TEST(IkGeoVectors, SubproblemsOfSeveralTurns) {
  GONIO_NEEDS_DATA("robots/ik-geo");
  for (const auto& cells : vectors_of("sp_2.csv")) {
    const Row r{cells};
    expect_pair(sp2(r.vec(0), r.vec(3), r.vec(1), r.vec(2)), r.number(12), r.number(13));
  }
  for (const auto& cells : vectors_of("sp_2E.csv")) {
    const Row r{cells};
    expect_pair(sp2_extended(r.vec(0), r.vec(1), r.vec(4), r.vec(2), r.vec(3)), r.number(15), r.number(16));
  }
  for (const auto& cells : vectors_of("sp_6.csv")) {
    const Row r{cells};
    std::array<Arm6, 4> arms;
    for (std::size_t i = 0; i < 4; ++i) arms[i] = {r.vec(i), r.vec(4 + i), r.vec(8 + i)};
    expect_pair(sp6(arms, r.number(36), r.number(37)), r.number(38), r.number(39));
  }
  for (const auto& cells : vectors_of("sp_5.csv")) {
    const Row r{cells};
    double best = 10;
    for (const Triple& t : sp5(r.vec(6), r.vec(0), r.vec(1), r.vec(2), r.vec(3), r.vec(4), r.vec(5)))
      best = std::min(best, std::max({off(t.first_rad, r.number(21)), off(t.second_rad, r.number(22)),
                                      off(t.third_rad, r.number(23))}));
    EXPECT_LT(best, 1e-7);
  }
}

// Axes h and ways p from axis to axis, as ik-geo describes arms.
struct Described {
  std::array<Vec3, 6> h;
  std::array<Vec3, 7> p;
};

ChainRows rows_of_described(const Described& arm) {
  std::vector<AxisLine> lines;
  Vec3 at;
  for (std::size_t i = 0; i < 6; ++i) lines.push_back({arm.h[i], at += arm.p[i]});
  return rows_of(lines, {{}, at + arm.p[6]});
}

// R column by column, T, then the joints that made them; the pose may be rounded by the makers.
void expect_found(const Described& arm, const Row& r, std::size_t first, Family family, double rounding_rad = 1e-7) {
  const ChainRows rows = rows_of_described(arm);
  const InverseKinematics inverse(rows.links);
  EXPECT_EQ(inverse.family(), family);
  Mat3 rotation;
  for (int i = 0; i < 9; ++i) rotation(i % 3, i / 3) = r.number(first + static_cast<std::size_t>(i));
  const Vec3 place{r.number(first + 9), r.number(first + 10), r.number(first + 11)};
  const Rigid<frame::Base, frame::Tool> pose{quaternion_of(rotation), place};
  Joints joints;
  for (std::size_t i = 0; i < 6; ++i) joints[i] = r.number(first + 12 + i);
  const auto of_rows = gonio::inverse(rows.base_from_first) * pose * gonio::inverse(rows.last_from_flange);
  const Miss own = miss_of(rows.links, joints, of_rows);
  EXPECT_LT(own.position_m, 1e-12);  // the rows are the arm
  EXPECT_LT(own.rotation_rad, 1e-12);
  const auto answers = inverse.solve(of_rows);
  ASSERT_FALSE(answers.empty());
  for (const JointAnswer& a : answers) {
    EXPECT_TRUE(a.exact);
    EXPECT_LT(miss_of(rows.links, a.joints_rad, of_rows).position_m, 1e-11);
  }
  EXPECT_LT(wrapped_difference(nearest(answers, joints)->joints_rad, joints), rounding_rad);
}

Described described(const Row& r) {
  Described arm;
  for (std::size_t i = 0; i < 6; ++i) arm.h[i] = r.vec(i);
  for (std::size_t i = 0; i < 7; ++i) arm.p[i] = r.vec(6 + i);
  return arm;
}

TEST(IkGeoVectors, RobotsOfRandomGeometry) {
  GONIO_NEEDS_DATA("robots/ik-geo");
  for (const auto& cells : vectors_of("IK_spherical.csv"))
    expect_found(described({cells}), {cells}, 39, Family::spherical_wrist);
  for (const char* name : {"IK_3_parallel.csv", "IK_3_parallel_2_intersecting.csv"})
    for (const auto& cells : vectors_of(name)) expect_found(described({cells}), {cells}, 39, Family::three_parallel);
}

TEST(IkGeoVectors, NamedRobots) {
  GONIO_NEEDS_DATA("robots/ik-geo");
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const Described three{{z, x, x, x, z, x}, {z, y, y, y, y, x + y, x}};
  for (const auto& cells : vectors_of("three_parallel_bot.csv"))
    expect_found(three, {cells}, 0, Family::three_parallel);
  const Described ur5{
      {z, y, y, y, -z, y},
      {z * 0.089159, y * 0.1358, x * 0.425 - y * 0.1197, x * 0.3922, y * 0.093 - z * 0.0946, {}, y * 0.0823}};
  for (const auto& cells : vectors_of("ur5.csv")) expect_found(ur5, {cells}, 0, Family::three_parallel);
}

}  // namespace
}  // namespace gonio::robot
