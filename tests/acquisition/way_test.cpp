// Ways: their times, what is found fault with, straight ones, searched ones, and the walk of an independent checker.
#include "acquisition/motion/way.h"

#include <gmock/gmock.h>

#include <cmath>

#include "acquisition/laboratories.h"
#include "acquisition/motion/line.h"
#include "acquisition/way_check.h"
#include "base/random.h"

namespace gonio::acquisition {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct World {
  manifest::Document document;
  Laboratory laboratory;
  Surroundings surroundings;
  explicit World(const std::string& text)
      : document(tests::laboratory_document(text)),
        laboratory(believed_laboratory(document)),
        surroundings(laboratory) {}
};
const World& two_ur5() {
  static const World world(tests::two_ur5_text());
  return world;
}

// Accelerates where the rest can still be braked, in steps of a microsecond.
double integrated_time(double distance, double speed, double acceleration) {
  double done = 0, v = 0, t = 0;
  const double dt = 1e-5;
  while (done < distance) {
    const double braking = v * v / (2 * acceleration);
    if (distance - done <= braking)
      v -= acceleration * dt;
    else
      v = std::min(v + acceleration * dt, speed);
    if (v <= 0) break;
    done += v * dt;
    t += dt;
  }
  return t;
}

TEST(Timing, TrapezoidsTakeAsLongAsTheirIntegral) {
  for (const auto& [distance, speed, acceleration] :
       {std::array{1.0, 0.5, 2.0}, {0.05, 1.0, 2.0}, {3.0, 1.5, 0.4}, {0.5, 1.0, 2.0}, {-1.0, 0.5, 2.0}})
    EXPECT_NEAR(trapezoid_time(distance, speed, acceleration),
                integrated_time(std::fabs(distance), speed, acceleration),
                0.002 + 0.003 * trapezoid_time(distance, speed, acceleration));
  EXPECT_EQ(trapezoid_time(0, 1, 1), 0);
}

TEST(Timing, OfALineIsTheSlowestJointsAndCuttingItChangesNothing) {
  Laboratory laboratory = two_ur5().laboratory;
  laboratory.speed_m_per_s = 1e9;
  const LaboratoryArm& arm = laboratory.arms.at("camera-arm");
  const Joints from = arm.home;
  Joints to = from;
  to[0] += 1.2;
  EXPECT_NEAR(line_time(arm, from, to), trapezoid_time(1.2, arm.limits[0].speed_rad_per_s, 5), 1e-12);
  to[3] += 0.3, to[4] -= 0.7;
  EXPECT_NEAR(line_time(arm, from, to), trapezoid_time(1.2, arm.limits[0].speed_rad_per_s, 5), 1e-12);
  const State start{{"camera-arm", from}}, end{{"camera-arm", to}};
  EXPECT_NEAR(way_time(laboratory, {start, end}), line_time(arm, from, to), 1e-9);
  Way cut;
  for (int i = 0; i <= 50; ++i) cut.push_back(between(laboratory, start, end, i / 50.0));
  EXPECT_NEAR(way_time(laboratory, cut), line_time(arm, from, to), 1e-6);
  // At a corner all joints stand.
  Joints back = to;
  back[1] += 0.5;
  EXPECT_NEAR(way_time(laboratory, {start, end, {{"camera-arm", back}}}),
              line_time(arm, from, to) + line_time(arm, to, back), 1e-9);
  // No flange is faster than the laboratory allows: at a tenth of a metre per second, an arc of 1.2 rad takes long.
  laboratory.speed_m_per_s = 0.1;
  const auto a = world_from_tool(arm, from), b = world_from_tool(arm, to);
  EXPECT_GT(way_time(laboratory, {start, end}), norm(a.translation_m - b.translation_m) / 0.1);
}

TEST(Judge, NamesWhatIsBroken) {
  const World& w = two_ur5();
  const State home{};
  EXPECT_EQ(judge(w.laboratory, w.surroundings, {home}).fault, "");
  const auto with = [&](int joint, double by) {
    State state{{"camera-arm", w.laboratory.arms.at("camera-arm").home}};
    state["camera-arm"][static_cast<std::size_t>(joint)] += by;
    return judge(w.laboratory, w.surroundings, {home, state});
  };
  EXPECT_THAT(with(0, 4).fault, HasSubstr("camera-arm: joint 1 at 2"));
  EXPECT_THAT(with(0, 4).fault, HasSubstr("limit 200.5 deg"));
  EXPECT_THAT(with(1, 1.8).fault, ::testing::ContainsRegex("mm apart, limit 10.0 mm|meet|z = "));
  EXPECT_THAT(with(4, 1.5).fault, HasSubstr("smallest singular value"));
  const WayFigures good = with(0, 0.2);
  EXPECT_EQ(good.fault, "");
  EXPECT_DOUBLE_EQ(good.largest_turn_rad, 0.2);
  EXPECT_GT(good.clearance_m, 0.0098);
  EXPECT_GT(good.smallest_singular_m, 0.01);
  EXPECT_GT(good.duration_s, 0);
}

TEST(Judge, AWayThatPassesWithAMarginPassesWithASmallerOne) {
  const World& w = two_ur5();
  Random random(31);
  int passed_small = 0, passed_large = 0;
  Laboratory large = w.laboratory;
  large.margin_m = 0.05;
  for (int k = 0; k < 30; ++k) {
    State to{{"camera-arm", w.laboratory.arms.at("camera-arm").home},
             {"light-arm", w.laboratory.arms.at("light-arm").home}};
    for (auto& [name, joints] : to)
      for (double& q : joints) q += random.uniform(-0.6, 0.6);
    const bool small_ok = judge(w.laboratory, w.surroundings, {{}, to}).fault.empty();
    const bool large_ok = judge(large, w.surroundings, {{}, to}).fault.empty();
    EXPECT_TRUE(small_ok || !large_ok);
    passed_small += small_ok, passed_large += large_ok;
    EXPECT_EQ(small_ok, open_line(w.laboratory, w.surroundings, {}, to)) << k;
  }
  EXPECT_GT(passed_small, passed_large);
  EXPECT_LT(passed_small, 30);
}

double off_line(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 u = normalized(b - a);
  return norm((p - a) - u * dot(p - a, u));
}

TEST(StraightWay, KeepsTheToolOnTheLine) {
  const World& w = two_ur5();
  const LaboratoryArm& arm = w.laboratory.arms.at("camera-arm");
  const auto start = world_from_tool(arm, arm.home);
  auto end = start;
  end.translation_m += Vec3{0.05, 0.15, 0.1};
  end.rotation = normalized(quaternion_of_rotation_vector({0.2, 0.1, -0.3}) * start.rotation);
  std::string why;
  const auto way = straight_way(w.laboratory, {}, "camera-arm", end, 1e-4, &why);
  ASSERT_TRUE(way) << why;
  ASSERT_GT(way->size(), 5u);
  const auto reached = world_from_tool(arm, way->back().at("camera-arm"));
  EXPECT_LT(norm(reached.translation_m - end.translation_m), 1e-8);
  EXPECT_LT(norm(rotation_vector_of(normalized(reached.rotation * conjugate(end.rotation)))), 1e-8);
  double worst = 0, worst_turn = 0;
  const Vec3 whole = rotation_vector_of(normalized(end.rotation * conjugate(start.rotation)));
  for (std::size_t i = 0; i + 1 < way->size(); ++i)
    for (const double t : {0.25, 0.5, 0.75}) {
      const State middle = between(w.laboratory, (*way)[i], (*way)[i + 1], t);
      const auto tool = world_from_tool(arm, middle.at("camera-arm"));
      worst = std::max(worst, off_line(tool.translation_m, start.translation_m, end.translation_m));
      const double share =
          norm(tool.translation_m - start.translation_m) / norm(end.translation_m - start.translation_m);
      const Quaternion even = normalized(quaternion_of_rotation_vector(whole * share) * start.rotation);
      worst_turn = std::max(worst_turn, norm(rotation_vector_of(normalized(tool.rotation * conjugate(even)))));
    }
  EXPECT_LT(worst, 1e-4);
  EXPECT_LT(worst_turn, 0.01);
  EXPECT_EQ(judge(w.laboratory, w.surroundings, *way).fault, "");
}

TEST(StraightWay, SaysWhereTheLineEnds) {
  const World& w = two_ur5();
  const auto start = world_from_tool(w.laboratory.arms.at("camera-arm"), w.laboratory.arms.at("camera-arm").home);
  auto far = start;
  far.translation_m += Vec3{0, 0, 1.5};
  std::string why;
  EXPECT_FALSE(straight_way(w.laboratory, {}, "camera-arm", far, 1e-4, &why));
  EXPECT_THAT(why, StartsWith("camera-arm: "));
  EXPECT_THAT(why, HasSubstr("% of the line"));
  EXPECT_THAT(why, ::testing::ContainsRegex("singular|out of reach|flip"));
  EXPECT_FALSE(straight_way(w.laboratory, {}, "camera-arm", far, 1e-4, nullptr));
}

// A pillar stands where the flange is in the middle of the straight line, and ends a little above it.
TEST(JointWay, LeadsRoundAPillarTheSameWayForTheSameSeed) {
  const World open(tests::ur3_and_turntable_text());
  const auto turned = [&](double by) {
    State state{{"arm", open.laboratory.arms.at("arm").home}};
    state["arm"][0] += by;
    return state;
  };
  const State left = turned(0.8), right = turned(-0.8), middle = turned(0);
  const Vec3 flange = world_from_tool(open.laboratory.arms.at("arm"), middle.at("arm")).translation_m;
  std::string text = tests::ur3_and_turntable_text();
  const std::string list = "\"obstacles\": [";
  text.insert(text.find(list) + list.size(),
              R"({"name": "pillar", "cylinder_m": [0.03, 0.5], "world_from_body": {"rotation": [1, 0, 0, 0],
                 "translation_m": [)" +
                  std::to_string(flange.x) + ", " + std::to_string(flange.y) + ", " + std::to_string(flange.z - 0.22) +
                  "]}}, ");
  const World w(text);
  ASSERT_EQ(judge(w.laboratory, w.surroundings, {left}).fault, "");
  ASSERT_EQ(judge(w.laboratory, w.surroundings, {right}).fault, "");
  EXPECT_THAT(judge(w.laboratory, w.surroundings, {left, right}).fault, HasSubstr("pillar"));
  EXPECT_FALSE(open_line(w.laboratory, w.surroundings, left, right));
  const auto way = joint_way(w.laboratory, w.surroundings, left, right, 3);
  ASSERT_TRUE(way);
  EXPECT_GT(way->size(), 2u);
  EXPECT_EQ(judge(w.laboratory, w.surroundings, *way).fault, "");
  EXPECT_EQ(way->front().at("arm"), left.at("arm"));
  EXPECT_EQ(way->back().at("arm"), right.at("arm"));
  EXPECT_EQ(joint_way(w.laboratory, w.surroundings, left, right, 3), way);
  EXPECT_GT(tests::check_way(w.laboratory, *way, 0.01, 0.02).nearest_m, 0);
  // What stands in the pillar goes nowhere.
  EXPECT_FALSE(joint_way(w.laboratory, w.surroundings, left, middle, 3, 50));
}

// Lines from home into all directions, of both arms: what the judge passes, the checker passes; where the judge sees
// solids meet, so does the checker.
TEST(Judge, AgreesWithAnIndependentWalk) {
  const World& w = two_ur5();
  Random random(77);
  int passed = 0, met = 0;
  for (int k = 0; passed + met < 5 && k < 200; ++k) {
    State to{{"camera-arm", w.laboratory.arms.at("camera-arm").home},
             {"light-arm", w.laboratory.arms.at("light-arm").home}};
    for (auto& [name, joints] : to)
      for (double& q : joints) q += random.uniform(-0.8, 0.8);
    const Way way{{}, to};
    const WayFigures figures = judge(w.laboratory, w.surroundings, way);
    if (figures.fault.empty() && passed < 3) {
      ++passed;
      const tests::WayCheck check = tests::check_way(w.laboratory, way, 0.008, 0.02);
      EXPECT_GT(check.nearest_m, 0) << check.first << " and " << check.second;
    } else if (figures.clearance_m <= 0 && met < 2) {
      ++met;
      const tests::WayCheck check = tests::check_way(w.laboratory, way, 0.008, 0.02);
      EXPECT_LT(check.nearest_m, 0.015) << figures.fault;
    }
  }
  EXPECT_EQ(passed, 3);
}

}  // namespace
}  // namespace gonio::acquisition
