// Poses in blocks under "Rotation:" and "Translation:", in the many ways in which tools print them: each is one and the
// same pose; and each kind of a bad block.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "robot/pose_list.h"

namespace gonio::robot {
namespace {

using testing::HasSubstr;

PoseListFormat blocks_format(const std::string& convention = "matrix", const std::string& length = "",
                             const std::string& direction = "base_from_tool") {
  return pose_list_format(convention, length, "", direction, "--pose-format");
}

// A quarter turn about z at (0.5, -0.25, 1.5) m.
void expect_quarter_turn(const Rigid<frame::Base, frame::Tool>& pose) {
  const Mat3 r = matrix_of(pose.rotation);
  const std::array<double, 9> expected = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(r.m[i], expected[i], 1e-6) << i;
  EXPECT_NEAR(norm(pose.translation_m - Vec3{0.5, -0.25, 1.5}), 0, 1e-9);
}

TEST(PoseBlocks, OnePoseInEveryPrintIsOnePose) {
  const std::string rows = "0 -1 0\n1 0 0\n0 0 1\n";
  const std::vector<std::pair<std::string, PoseListFormat>> cases = {
      {"Rotation:\n" + rows + "Translation:\n0.5 -0.25 1.5\n", blocks_format()},
      {"Rotation:\r\n0\t-1\t0\r\n1\t0\t0\r\n0\t0\t1\r\nTranslation:\r\n0.5\r\n-0.25\r\n1.5\r\n", blocks_format()},
      {"Translation:\n500, -250, 1500\n\nRotation:\n\n" + rows, blocks_format("matrix", "mm")},
      {"Rotation matrix\n" + rows + "Translation vector\n0.5 -0.25 1.5", blocks_format()},
      {"ROTATION MATRIX =\n[[0, -1, 0],\n [1, 0, 0],\n [0, 0, 1]]\nTRANSLATION VECTOR =\n[0.5, -0.25, 1.5]\n",
       blocks_format()},
      {"R = [0 -1 0; 1 0 0; 0 0 1]\nt = [0.5; -0.25; 1.5]\n", blocks_format()},
      {"Rotation: [0, -1, 0, 1, 0, 0, 0, 0, 1]\nTranslation (mm): [500, -250, 1500]\n", blocks_format("matrix", "mm")},
      {"{\"rotation\": [[0, -1, 0], [1, 0, 0], [0, 0, 1]],\n \"translation\": [0.5, -0.25, 1.5]}\n", blocks_format()},
      {"# base to tool\nPose 1\n------\nRotation 1\n" + rows + "Translation 1\n0.5 -0.25 1.5\n", blocks_format()},
      {"Rotation:\n0 1 0\n-1 0 0\n0 0 1\nTranslation:\n0.25 0.5 -1.5\n", blocks_format("matrix", "", "tool_from_base")},
      {"Rotation: 0 0 1.57079632679\nTranslation: 0.5 -0.25 1.5\n", blocks_format("rotation-vector")},
      {"Translation: 500 -250 1500\nRotation: 0.70710678 0 0 0.70710678\n", blocks_format("abb")},
  };
  for (const auto& [text, format] : cases) {
    SCOPED_TRACE(text);
    const PoseList list = parse_pose_list(text, "p.txt", format);
    ASSERT_EQ(list.poses.size(), 1u);
    expect_quarter_turn(list.poses[0].base_from_tool);
  }
}

TEST(PoseBlocks, SeveralInOneFileWithNamesAndPlaces) {
  std::string text;
  for (int i = 1; i <= 12; ++i)
    text += "Image: view_" + std::to_string(i) + ".png\n\nRotation:\n0 -1 0\n1 0 0\n0 0 1\n\nTranslation:\n0.5 -0.25 " +
            std::to_string(i) + "\n\n";
  const PoseList list = parse_pose_list(text, "p.txt", blocks_format());
  ASSERT_EQ(list.poses.size(), 12u);
  for (int i = 0; i < 12; ++i)
    EXPECT_NEAR(list.poses[static_cast<std::size_t>(i)].base_from_tool.translation_m.z, i + 1, 1e-12);
  EXPECT_EQ(list.poses[6].name, "view_7.png");
  EXPECT_EQ(list.poses[1].place, "p.txt:13");
  // numbered by lines of their own
  const PoseList numbered = parse_pose_list(
      "1\nR:\n1 0 0\n0 1 0\n0 0 1\nT:\n1\n2\n3\n2\nR:\n1 0 0\n0 1 0\n0 0 1\nT:\n4\n5\n6\n", "p.txt", blocks_format());
  ASSERT_EQ(numbered.poses.size(), 2u);
  EXPECT_EQ(numbered.poses[1].name, "2");
  EXPECT_EQ(numbered.poses[1].base_from_tool.translation_m.x, 4);
}

TEST(PoseBlocks, OneInEveryFile) {
  const tests::ScratchFolder folder;
  std::vector<std::filesystem::path> files;
  for (const char* name : {"a.txt", "b.txt"}) {
    write_file(folder / name, "Rotation:\n0 -1 0\n1 0 0\n0 0 1\nTranslation:\n0.5 -0.25 1.5\n");
    files.push_back(folder / name);
  }
  const PoseList list = read_pose_files(files, blocks_format());
  ASSERT_EQ(list.poses.size(), 2u);
  EXPECT_EQ(list.poses[1].name, "b");
  expect_quarter_turn(list.poses[1].base_from_tool);
}

TEST(PoseBlocks, ListsWhoseNamesOrHeadingsLookAlikeStayLists) {
  EXPECT_EQ(
      parse_pose_list("name Rot_x Rot_y Rot_z x y z\nr2 1 2 3 0 0 0\n", "p.txt", blocks_format("ur")).poses.size(), 1u);
  EXPECT_EQ(parse_pose_list("R1: 1 2 3 0 0 0\nT2: 1 2 3 0 0 0\n", "p.txt", blocks_format("ur")).poses.size(), 2u);
}

TEST(PoseBlocks, BadBlocksAreNamedWithTheirRemedy) {
  const auto refused = [](const std::string& text, const std::string& words,
                          const PoseListFormat& format = blocks_format()) {
    SCOPED_TRACE(text);
    try {
      parse_pose_list(text, "p.txt", format);
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  };
  const std::string rotation = "Rotation:\n0 -1 0\n1 0 0\n0 0 1\n", translation = "Translation:\n0.5 -0.25 1.5\n";
  refused(rotation, "p.txt:1: a rotation without a translation");
  refused(translation, "p.txt:1: a translation without a rotation");
  refused(rotation + translation + rotation, "p.txt:7: a rotation without a translation");
  refused(rotation + rotation + translation, "p.txt:1: a rotation without");
  refused("Rotation:\n0 -1 0\n1 0 0\n" + translation, "p.txt:1: a rotation of 6 numbers");
  refused(rotation + "Translation:\n0.5 -0.25\n", "p.txt:5: a translation of 2 numbers");
  refused(rotation + "0 0 0\n" + translation, "p.txt:5: numbers that belong to neither");
  refused("Rotation:\n0 -1 x\n1 0 0\n0 0 1\n" + translation, "p.txt:2: \"x\" is no number");
  refused("Rotation:\n0 -1 nan\n1 0 0\n0 0 1\n" + translation, "finite");
  refused("Rotation:\n0 -1,0 0\n1 0 0\n0 0 1\n" + translation, "decimal comma");
  refused("Rotation:\n0 1 0\n1 0 0\n0 0 1\n" + translation, "left-handed");
  refused("Rotation:\n0 -1.1 0\n1 0 0\n0 0 1\n" + translation, "not orthonormal");
  refused(rotation + "Translation:\n500 -250 1500\n", "millimetres? then name mm");
  refused(rotation + "Translation (mm):\n5 -2 1\n",
          "p.txt:1: its translation is stated in mm");
  refused(rotation + translation, "16 numbers where 6", blocks_format("ur"));
  refused("Rotation:\nTranslation:\n", "a translation of 0 numbers");
}

}  // namespace
}  // namespace gonio::robot
