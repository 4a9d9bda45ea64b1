// Pose lists: every convention against rotations written out by hand, real lists against each other, and each kind of
// bad line.
#include "robot/pose_list.h"

#include <gmock/gmock.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"

namespace gonio::robot {
namespace {

PoseListFormat format(const std::string& convention, const std::string& length = "", const std::string& angle = "",
                      const std::string& direction = "base_from_tool") {
  return pose_list_format(convention, length, angle, direction, "--poses");
}
Rigid<frame::Base, frame::Tool> one(const std::string& text, const PoseListFormat& f) {
  const PoseList list = parse_pose_list(text, "p.txt", f);
  EXPECT_EQ(list.poses.size(), 1u);
  return list.poses.at(0).base_from_tool;
}
void expect_rotation(const Quaternion& q, const std::array<double, 9>& expected, double within = 1e-12) {
  const Mat3 r = matrix_of(q);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(r.m[i], expected[i], within) << i;
}
std::array<double, 9> about(char axis, double a) {
  const double c = std::cos(a), s = std::sin(a);
  if (axis == 'x') return {1, 0, 0, 0, c, -s, 0, s, c};
  if (axis == 'y') return {c, 0, s, 0, 1, 0, -s, 0, c};
  return {c, -s, 0, s, c, 0, 0, 0, 1};
}
std::array<double, 9> product(const std::array<double, 9>& a, const std::array<double, 9>& b,
                              const std::array<double, 9>& c) {
  return (Mat3{a} * Mat3{b} * Mat3{c}).m;
}

TEST(PoseList, EulerConventionsAreProductsOfTurnsInTheirOrder) {
  const double a = 0.3, b = -0.8, c = 1.9;
  const std::string rad = "0.1 0.2 0.3 0.3 -0.8 1.9";
  expect_rotation(one(rad, format("euler-zyx", "", "rad")).rotation,
                  product(about('z', a), about('y', b), about('x', c)));
  expect_rotation(one(rad, format("fixed-xyz", "", "rad")).rotation,
                  product(about('z', c), about('y', b), about('x', a)));
  expect_rotation(one(rad, format("rpy")).rotation, product(about('z', c), about('y', b), about('x', a)));
  expect_rotation(one(rad, format("euler-zyz", "", "rad")).rotation,
                  product(about('z', a), about('y', b), about('z', c)));
  const std::string deg = "100 200 300 10 20 30";
  const double d = pi / 180;
  expect_rotation(one(deg, format("kuka")).rotation,
                  product(about('z', 10 * d), about('y', 20 * d), about('x', 30 * d)));
  expect_rotation(one(deg, format("fanuc")).rotation,
                  product(about('z', 30 * d), about('y', 20 * d), about('x', 10 * d)));
  expect_rotation(one(deg, format("abb-euler")).rotation,
                  product(about('z', 30 * d), about('y', 20 * d), about('x', 10 * d)));
  expect_rotation(one(deg, format("staubli")).rotation,
                  product(about('x', 10 * d), about('y', 20 * d), about('z', 30 * d)));
  EXPECT_NEAR(norm(one(deg, format("kuka")).translation_m - Vec3{0.1, 0.2, 0.3}), 0, 1e-15);
}

TEST(PoseList, OnePoseInEveryConventionIsOnePose) {
  // A turn of 90 degrees about z at (0.5, -0.25, 1.5) m.
  const double h = std::sqrt(0.5);
  const std::string half = std::to_string(h), quarter = std::to_string(pi / 2);
  const std::vector<std::pair<std::string, PoseListFormat>> cases = {
      {"0.5 -0.25 1.5 0 0 " + quarter, format("ur")},
      {"p[0.5, -0.25, 1.5, 0, 0, " + quarter + "]", format("ur")},
      {"500;-250;1500;0;0;90", format("rotation-vector", "mm", "deg")},
      {"[[500,-250,1500],[" + half + ",0,0," + half + "]]", format("abb")},
      {"0.5,-0.25,1.5," + half + ",0,0," + half, format("quaternion-wxyz")},
      {"0.5, -0.25, 1.5, 0, 0, " + half + ", " + half, format("quaternion-xyzw")},
      {"50 -25 150 0 0 90", format("rpy", "cm", "deg")},
      {"500\t-250\t1500\t90\t0\t0", format("kuka")},
      {"0 -1 0 0.5 1 0 0 -0.25 0 0 1 1.5 0 0 0 1", format("matrix")},
      {"0 -1 0 0.5\r\n1 0 0 -0.25\r\n0 0 1 1.5\r\n0 0 0 1\r\n", format("matrix")},
      {"0 1 0 0.25\n-1 0 0 0.5\n0 0 1 -1.5\n0 0 0 1\n", format("matrix", "", "", "tool_from_base")},
      {"# poses\nx,y,z,rx,ry,rz\n\n0.5,-0.25,1.5,0,0," + quarter + "\n", format("ur")},
  };
  for (const auto& [text, f] : cases) {
    SCOPED_TRACE(text);
    const auto pose = one(text, f);
    expect_rotation(pose.rotation, {0, -1, 0, 1, 0, 0, 0, 0, 1}, 2e-6);
    EXPECT_NEAR(norm(pose.translation_m - Vec3{0.5, -0.25, 1.5}), 0, 1e-12);
  }
}

TEST(PoseList, NamesAndPlacesAreKept) {
  const PoseList list = parse_pose_list(
      "image x y z rx ry rz\nview_07.png 0.1 0 0 0 0 1\n\nview_08.png 0.2 0 0 0 0 2\n", "p.csv", format("ur"));
  ASSERT_EQ(list.poses.size(), 2u);
  EXPECT_EQ(list.poses[1].name, "view_08.png");
  EXPECT_EQ(list.poses[1].place, "p.csv:4");
}

TEST(PoseList, RoundedMatricesBecomeRotations) {
  const auto pose =
      one("0.36000 0.48003 -0.80000 1 -0.80001 0.60000 0 2 0.48000 0.64000 0.60002 3 0 0 0 1", format("matrix"));
  const Mat3 r = matrix_of(pose.rotation), square = transposed(r) * r;
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(square.m[static_cast<std::size_t>(i)], i % 4 == 0 ? 1 : 0, 1e-15);
  EXPECT_NEAR(r(0, 1), 0.48, 3e-5);
}

void expect_refused(const std::string& text, const PoseListFormat& f, const std::string& words) {
  try {
    parse_pose_list(text, "p.txt", f);
    FAIL() << "accepted: " << text;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr(words), testing::HasSubstr("p.txt")));
  }
}

TEST(PoseList, BadLinesAreNamedWithTheirRemedy) {
  expect_refused("", format("ur"), "no pose");
  expect_refused("1 2 3 0 0 0\n1 2 3 0 0\n", format("ur"), "p.txt:2: 5 numbers where 6");
  expect_refused("1 2 3 1 0 0 0", format("ur"), "7 numbers where 6");
  expect_refused("1 2 3 0 0 0", format("abb"), "6 numbers where 7");
  expect_refused("1 2 3 0 0 nan", format("ur"), "finite");
  expect_refused("1 2 3 0 inf 0", format("ur"), "finite");
  expect_refused("1 2 x 0 0 0", format("ur"), "\"x\" is no number");
  expect_refused("1,,3,0,0,0", format("ur"), "empty field");
  expect_refused("0,5 0,25 1,5 0,0 0,0 1,0", format("ur"), "decimal comma");
  expect_refused("0,5; 0,25; 1,5; 0,0; 0,0; 1,0", format("ur"), "decimal comma");
  expect_refused("1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1", format("matrix"), "left-handed");
  expect_refused("1 0 0.01 0 0 1 0 0 0 0 1 0 0 0 0 1", format("matrix"), "not orthonormal (|R'R - I| = 0.01");
  expect_refused("1 0 0 0 0 1 0 0 0 0 1 0 0.5 0 1 1", format("matrix"), "column-major");
  expect_refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n", format("matrix"), "fewer than four rows");
  expect_refused("1 2 3 0.9 0 0 0", format("quaternion-wxyz"), "unit length");
  expect_refused("1 2 3 180 0 0", format("ur"), "degrees? then name deg");
  expect_refused("1 2 3 0 0 90", format("rpy"), "degrees? then name deg");
  expect_refused("500 -250 1500 0 0 1", format("ur"), "millimetres? then name mm");
}

TEST(PoseList, ConventionsAreNeverGuessed) {
  const auto refused = [](auto call, const std::string& words) {
    try {
      call();
      FAIL() << "accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::usage);
      EXPECT_THAT(e.what(), testing::HasSubstr(words));
    }
  };
  refused([] { format("quaternion"); }, "quaternion-wxyz, quaternion-xyzw");
  refused([] { format("euler-zzx"); }, "no convention");
  refused([] { format("euler-zyx"); }, "rad or deg");
  refused([] { format("abb", "", "deg"); }, "no angles");
  refused([] { format("ur", "inch"); }, "m, cm, mm");
  refused([] { format("ur", "", "", "tool"); }, "base_from_tool or tool_from_base");
}

TEST(PoseList, OddListsAreWarnedOf) {
  std::string radians, metres;
  for (int i = 0; i < 6; ++i) {
    radians += "100 " + std::to_string(100 * i) + " 300 " + std::to_string(0.5 * i) + " 1 -3.1\n";
    metres += "0.1 0." + std::to_string(i) + " 0.3 " + std::to_string(20 * i) + " 1 -3.1\n";
  }
  EXPECT_THAT(parse_pose_list(radians, "p", format("kuka")).warnings,
              testing::ElementsAre(testing::HasSubstr("radians read as")));
  EXPECT_THAT(parse_pose_list(metres, "p", format("kuka")).warnings,
              testing::ElementsAre(testing::HasSubstr("metres read as")));
}

TEST(PoseList, ReadsTheRecordedLists) {
  GONIO_NEEDS_DATA("handeye");
  const PoseList kuka = read_pose_list(tests::data("handeye/rwhe_kuka_3/RobotPosesVec.txt"), format("matrix"));
  EXPECT_EQ(kuka.poses.size(), 29u);
  EXPECT_NEAR(kuka.poses[0].base_from_tool.translation_m.x, 1.20499707, 1e-12);
  const PoseList ur = read_pose_list(tests::data("handeye/ur5e_checkerboard_sdu/40_poses_test.txt"), format("ur"));
  EXPECT_EQ(ur.poses.size(), 40u);
  std::vector<std::filesystem::path> files;
  for (const char* name : {"000_pose.csv", "001_pose.csv"})
    files.push_back(tests::data("handeye/st_handeye_calib_a") / name);
  const PoseList single = read_pose_files(files, format("matrix"));
  ASSERT_EQ(single.poses.size(), 2u);
  EXPECT_EQ(single.poses[1].name, "001_pose");
  EXPECT_THROW(read_pose_list(tests::data("handeye/ur5e_checkerboard_sdu/40_poses_test.txt"), format("abb")), Error);
}

}  // namespace
}  // namespace gonio::robot
