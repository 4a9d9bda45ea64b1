// Arms: positions against the makers' published values and an independent implementation, derivatives against
// differences.
#include "robot/kinematics.h"

#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/robot.h"
#include "robot/ur_calibration.h"

namespace gonio::robot {
namespace {

std::vector<double> some_joints(std::uint64_t seed, std::size_t count) {
  Random random(seed, 7);
  std::vector<double> joints;
  for (std::size_t i = 0; i < count; ++i) joints.push_back((random.uniform() - 0.5) * 6);
  return joints;
}

// Every row: robot, model, six joints, calibrated, x y z, rotation row by row.
TEST(Kinematics, EqualsThePeerOnRealControllers) {
  GONIO_NEEDS_DATA("universal-robots/peer_fk.csv");
  std::ifstream file(tests::data("universal-robots/peer_fk.csv"));
  std::string line;
  std::getline(file, line);
  int rows = 0, with_calibration = 0;
  double worst_m = 0, worst = 0;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(fields, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), 21u);
    const auto number = [&](std::size_t i) { return std::stod(cells[i]); };
    ASSERT_EQ(cells[1], "UR10e");
    Arm arm = known_arm("ur10e", "test");
    const bool is_calibrated = number(8) == 1;
    if (is_calibrated) {
      const auto folder = tests::data("universal-robots/calibration_conf") / cells[0];
      arm = calibrated(arm, read_ur_calibration(folder / "calibration.conf"), "test");
    }
    std::vector<double> joints;
    for (std::size_t i = 2; i < 8; ++i) joints.push_back(number(i));
    const auto pose = flange(arm.links, joints);
    worst_m = std::max(worst_m, norm(pose.translation_m - Vec3{number(9), number(10), number(11)}));
    Mat3 peer;
    for (std::size_t i = 0; i < 9; ++i) peer.m[i] = number(12 + i);
    worst = std::max(worst, norm(rotation_vector_of(conjugate(quaternion_of(peer)) * pose.rotation)));
    ++rows, with_calibration += is_calibrated;
  }
  EXPECT_GE(rows, 24);
  EXPECT_GE(with_calibration, 12);
  EXPECT_LT(worst_m, 1e-9);
  EXPECT_LT(worst, 1e-9);
  RecordProperty("worst_m", std::to_string(worst_m));
}

// URDF chains, T = product of Txyz Rz(yaw) Ry(pitch) Rx(roll) Rz(q): another writing of the same arms by other people.
std::vector<std::array<double, 6>> urdf_chain(const std::filesystem::path& path) {
  std::vector<std::array<double, 6>> chain;
  std::istringstream lines(read_file(path));
  const std::map<std::string, std::size_t> keys = {{"x", 0}, {"y", 1}, {"z", 2}, {"roll", 3}, {"pitch", 4}, {"yaw", 5}};
  for (std::string key, rest; lines >> key;) {
    key.pop_back();
    if (key == "x") chain.push_back({});
    if (const auto found = keys.find(key); found != keys.end()) lines >> chain.back()[found->second];
    std::getline(lines, rest);
  }
  return chain;
}

TEST(Kinematics, EqualsTheRosDescriptions) {
  GONIO_NEEDS_DATA("universal-robots/default_kinematics");
  for (const char* name : {"ur3", "ur5", "ur5e"}) {
    const auto chain = urdf_chain(tests::data("universal-robots/default_kinematics") /
                                  (std::string(name) + "_default_kinematics.yaml"));
    ASSERT_EQ(chain.size(), 6u);
    const std::vector<double> joints = some_joints(3, 6);
    Rigid<frame::Base, frame::Base> pose;
    for (std::size_t i = 0; i < 6; ++i) {
      const auto& c = chain[i];
      const auto turn = [](Vec3 v) { return quaternion_of_rotation_vector(v); };
      pose = pose * Rigid<frame::Base, frame::Base>{turn({0, 0, c[5]}) * turn({0, c[4], 0}) * turn({c[3], 0, 0}),
                                                    {c[0], c[1], c[2]}};
      pose = pose * Rigid<frame::Base, frame::Base>{turn({0, 0, joints[i]}), {}};
    }
    const auto own = flange(known_arm(name, "test").links, joints);
    EXPECT_LT(norm(own.translation_m - pose.translation_m), 1e-9) << name;
    EXPECT_LT(norm(rotation_vector_of(conjugate(pose.rotation) * own.rotation)), 2e-9) << name;
  }
}

void expect_at(const std::string& name, std::vector<double> degrees, Vec3 expected_m, const char* axis = nullptr) {
  for (double& d : degrees) d *= pi / 180;
  const auto pose = flange(known_arm(name, "test").links, degrees);
  EXPECT_LT(norm(pose.translation_m - expected_m), 1e-9)
      << name << " at " << pose.translation_m.x << ' ' << pose.translation_m.y << ' ' << pose.translation_m.z;
  if (axis != nullptr) {
    EXPECT_NEAR(dot(pose.rotate({0, 0, 1}), axis[0] == 'x' ? Vec3{1, 0, 0} : Vec3{0, 0, 1}), 1, 1e-12);
  }
}

// Product specification: flange (wrist centre + 65 mm) upright, stretched forward and upward; reach 1.45 and 1.2 m to
// the wrist.
TEST(Kinematics, AbbArmsStandWhereTheDataSheetDrawsThem) {
  expect_at("abb-irb-1600", {0, 0, 0, 0, 0, 0}, {0.15 + 0.6 + 0.065, 0, 0.4865 + 0.7}, "x");
  expect_at("abb-irb-1600-1.2", {0, 0, 0, 0, 0, 0}, {0.15 + 0.6 + 0.065, 0, 0.4865 + 0.475}, "x");
  expect_at("abb-irb-1600", {0, 90, -90, 0, 0, 0}, {1.45 + 0.065, 0, 0.4865}, "x");
  expect_at("abb-irb-1600-1.2", {0, 90, -90, 0, 0, 0}, {1.225 + 0.065, 0, 0.4865}, "x");
  expect_at("abb-irb-1600", {0, 0, -90, 0, 0, 0}, {0.15, 0, 0.4865 + 0.7 + 0.6 + 0.065}, "z");
  expect_at("abb-irb-1600", {90, 0, 0, 0, 0, 0}, {0, 0.815, 1.1865});
  expect_at("abb-irb-1600", {0, 0, 0, 0, 90, 0},
            {0.75, 0, 1.1865 - 0.065});                                    // positive turns of 2, 3, 5 lower the hand
  expect_at("abb-irb-1600", {0, 0, 0, 90, 90, 0}, {0.75, 0.065, 1.1865});  // 4 turns about the forearm, forwards
  // tool0 at zero: z forward, x downward.
  const auto zero = flange(known_arm("abb-irb-1600", "test").links, std::vector<double>(6, 0.0));
  EXPECT_NEAR(zero.rotate({1, 0, 0}).z, -1, 1e-12);
}

TEST(Kinematics, DerivativesAreThoseOfDifferences) {
  for (const Arm& arm : known_arms()) {
    const std::vector<double> joints = some_joints(11, 6);
    const std::vector<LinkMotions> motions = link_motions(arm.links, joints);
    const std::vector<Motion> by_joint = joint_motions(arm.links, joints);
    const auto difference = [&](std::size_t i, double Link::*member) {
      constexpr double step = 1e-6;
      std::vector<Link> up = arm.links, down = arm.links;
      up[i].*member += step, down[i].*member -= step;
      const auto a = flange(up, joints), b = flange(down, joints);
      return Motion{(a.translation_m - b.translation_m) / (2 * step),
                    rotation_vector_of(a.rotation * conjugate(b.rotation)) / (2 * step)};
    };
    const auto expect_same = [&](const Motion& a, const Motion& b) {
      EXPECT_LT(norm(a.shift_m - b.shift_m), 1e-8) << arm.name;
      EXPECT_LT(norm(a.turn_rad - b.turn_rad), 1e-8) << arm.name;
    };
    for (std::size_t i = 0; i < 6; ++i) {
      expect_same(motions[i].theta, difference(i, &Link::theta_rad));
      expect_same(motions[i].d, difference(i, &Link::d_m));
      expect_same(motions[i].a, difference(i, &Link::a_m));
      expect_same(motions[i].alpha, difference(i, &Link::alpha_rad));
      expect_same(by_joint[i], motions[i].theta);
    }
  }
}

TEST(Kinematics, AWeightPullsTheStretchedArmDown) {
  const Arm& arm = known_arm("abb-irb-1600", "test");
  const double right = pi / 2;
  const std::vector<double> levers = weight_levers(arm.links, std::vector<double>{0, right, -right, 0, 0, 0});
  EXPECT_NEAR(levers[0], 0, 1e-12);
  EXPECT_NEAR(levers[1], 0.7 + 0.6 + 0.065, 1e-9);  // forwards is down
  EXPECT_NEAR(levers[2], 0.6 + 0.065, 1e-9);
  EXPECT_NEAR(levers[4], 0.065, 1e-9);
}

TEST(UrCalibration, KeepsItsHundredsOfMetres) {
  GONIO_NEEDS_DATA("universal-robots/calibration_conf");
  const auto c = read_ur_calibration(tests::data("universal-robots/calibration_conf/robot_117/calibration.conf"));
  EXPECT_EQ(c.delta_d_m[1], 556.945558697223191);
  EXPECT_EQ(c.delta_theta_rad[2], -0.248944883246706716);
  EXPECT_EQ(c.delta_a_m[5], 0);
  EXPECT_EQ(c.status, 2);
}

void expect_refused(const std::string& text, const std::string& words) {
  try {
    parse_ur_calibration(text, "calibration.conf");
    FAIL() << "accepted: " << text;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_THAT(e.what(), testing::HasSubstr(words));
  }
}

TEST(UrCalibration, BrokenFilesAreNamed) {
  const std::string rows =
      "[mounting]\ndelta_theta = [1,2,3,4,5,6]\ndelta_a = [1,2,3,4,5,6]\ndelta_d = [1,2,3,4,5,6]\n";
  expect_refused(rows, "delta_alpha is missing");
  expect_refused(rows + "delta_alpha = [1,2,3]\n", "calibration.conf:5: delta_alpha has 3 numbers");
  expect_refused(rows + "delta_alpha = 1\n", "no list");
  expect_refused(rows + "delta_alpha = [1,2,3,4,5,x]\n", "\"x\"");
  expect_refused(rows + "delta_alpha = [1,2,3,4,5,nan]\n", "finite");
  expect_refused(rows + "delta_alpha = [1,2,3,4,5,6]\ncalibration_status = 0 # none\n", "never calibrated");
}

TEST(Kinematics, ArmsOfTheManifest) {
  manifest::Document document;
  document.robots["r"].model = "ur5e";
  EXPECT_EQ(arm_of(document, "r").links.size(), 6u);
  document.robots["r"] = {"dh", {{0.1, 0.2, 0, 0}, {0.3, 0, 0, 0}}, ""};
  EXPECT_EQ(arm_of(document, "r").links[1].a_m, 0.3);
  document.robots["r"] = {"dh", {}, ""};
  EXPECT_THROW(arm_of(document, "r"), Error);
  document.robots["r"] = {"puma", {}, ""};
  EXPECT_THROW(arm_of(document, "r"), Error);
  EXPECT_THROW(arm_of(document, "none"), Error);
}

}  // namespace
}  // namespace gonio::robot
