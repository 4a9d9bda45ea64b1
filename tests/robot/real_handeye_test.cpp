// The program on recorded sets, against what peers found in the same files (their SOURCE.md), and on what people get
// wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/frame_link.h"
#include "manifest/sections/mounting.h"
#include "process.h"
#include "robot/handeye_document.h"
#include "robot/one_noise.h"

namespace gonio::robot {
namespace {

using testing::Contains;
using testing::HasSubstr;
using Words = tests::Process::Words;

std::vector<std::string> files_of(const char* set, const std::string& ending) {
  std::vector<std::string> list;
  for (const auto& entry : std::filesystem::directory_iterator(tests::data(set)))
    if (entry.path().string().ends_with(ending)) list.push_back(entry.path().string());
  std::ranges::sort(list);
  return list;
}

// Calibrates the camera into `folder`/camera.json.
void calibrate(const Words& board, const std::vector<std::string>& pictures, const tests::ScratchFolder& folder) {
  Words words{"calib-charuco", "-o", (folder / "camera.json").string()};
  words.insert(words.end(), board.begin(), board.end());
  words.insert(words.end(), pictures.begin(), pictures.end());
  const tests::Ended ended = tests::run(words);
  ASSERT_TRUE(ended.status == 0 || ended.status == 2) << ended.err;
}

tests::Ended handeye(const tests::ScratchFolder& folder, const Words& options,
                     const std::string& manifest = "camera.json") {
  Words words{"handeye", "--allow-outside", (folder / manifest).string()};
  words.insert(words.end(), options.begin(), options.end());
  return tests::run(words);
}

// Lines of a list, numbered from 1, into `folder`/poses.txt.
std::string picked_lines(const std::filesystem::path& list, const std::vector<int>& lines,
                         const tests::ScratchFolder& folder) {
  std::ifstream in(list);
  std::vector<std::string> all;
  for (std::string line; std::getline(in, line);) all.push_back(line);
  std::string text;
  for (const int k : lines) text += all.at(static_cast<std::size_t>(k - 1)) + "\n";
  const std::string path = (folder / "poses.txt").string();
  write_file(path, text);
  return path;
}

struct Found {
  manifest::Mounting mounting;
  handeye::Analysis analysis;  // by the library, of the same input
};
Found found(const tests::Ended& ended) {
  const auto document = manifest::parse_document(ended.out, "out", ".", {.allow_outside = true});
  const HandEyeInput input = handeye_input(document, {});
  return {document.mountings.at("camera"), handeye::analyse(input.setup, input.views, "joint")};
}

// Held-out errors of all methods, printed for the record; the joint refinement's position against the best closed
// form's.
double ratio_to_best(const handeye::Analysis& a) {
  for (const auto& e : a.held_out)
    std::cout << e.method << ": " << e.rms.translation_m * 1e3 << " mm, " << e.rms.rotation_rad * 180 / pi << " deg, "
              << e.rms.rms_px << " px\n";
  return a.held_out_of("joint")->rms.translation_m / a.held_out_of(a.best_closed)->rms.translation_m;
}

TEST(RealHandEye, KukaWithSixViews) {
  constexpr const char* set = "handeye/rwhe_kuka_3/images";
  GONIO_NEEDS_DATA(set);
  const tests::ScratchFolder folder;
  calibrate({"--charuco", "12x9", "--square", "60mm", "--marker", "46mm", "--dictionary", "5X5_1000"},
            files_of(set, ".png"), folder);
  const auto list = tests::data("handeye/rwhe_kuka_3/RobotPosesVec.txt");
  const auto poses = picked_lines(list, {1, 7, 14, 18, 22, 27}, folder);
  const tests::Ended ended = handeye(folder, {"--poses", poses, "--pose-format", "matrix"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const Found f = found(ended);
  EXPECT_LE(ratio_to_best(f.analysis), 1.05);  // five views in every fit: the seven differ by 13 % among themselves
  EXPECT_LE(*f.mounting.scatter_m, 1.02 * 1.854e-3);
  tests::expect_one_figure(tests::both_noises(ended), 0.02);
  // The full set of 29 views, in an independent solution (Park): the difference lies within what is claimed here.
  const Vec3 peer{0.254557, 0.032541, -0.103472}, mine = f.mounting.tool_from_camera->translation_m;
  const auto& sigma = f.mounting.tool_from_camera->sigma->translation_m;
  EXPECT_NEAR(mine.x, peer.x, 3.5 * sigma[0]);
  EXPECT_NEAR(mine.y, peer.y, 3.5 * sigma[1]);
  EXPECT_NEAR(mine.z, peer.z, 3.5 * sigma[2]);
  // All 29 poses for 6 images.
  const tests::Ended wrong = handeye(folder, {"--poses", list.string(), "--pose-format", "matrix"});
  EXPECT_EQ(wrong.status, 65);
  EXPECT_THAT(wrong.err, HasSubstr("29 poses for 6 images"));
}

TEST(RealHandEye, NoisyRobotWithOnePoorView) {
  constexpr const char* set = "handeye/st_handeye_calib_a";
  GONIO_NEEDS_DATA(set);
  const tests::ScratchFolder folder;
  calibrate({"--checkerboard", "11x9", "--square", "20.2mm"}, files_of(set, "_image.jpg"), folder);
  Words options{"--pose-format", "matrix", "--html", (folder / "page.html").string()};
  for (const auto& file : files_of(set, "_pose.csv")) options.insert(options.end(), {"--poses", file});
  const tests::Ended ended = handeye(folder, options);
  ASSERT_EQ(ended.status, 0) << ended.err;
  const Found f = found(ended);
  EXPECT_THAT(f.mounting.outliers, Contains("009_image"));
  EXPECT_THAT(ended.err, HasSubstr("009_image: does not fit the others"));
  EXPECT_THAT(read_file(folder / "page.html"), HasSubstr("009_image: does not fit the others"));
  tests::expect_one_figure(tests::both_noises(ended), 0.02);  // of the poses that handeye kept
  EXPECT_LE(ratio_to_best(f.analysis), 1.05);
  EXPECT_LE(f.mounting.held_out->translation_m.value(), 6.528e-3);  // the peers' scatter of their fits, with all views
  // All views, outliers included: no worse than any closed form.
  const auto document = manifest::parse_document(ended.out, "out", ".", {.allow_outside = true});
  const HandEyeInput input = handeye_input(document, {});
  const double joint = handeye::held_out(input.setup, input.views, "joint").rms.translation_m;
  for (const char* name : {"tsai", "park", "horaud", "andreff", "daniilidis", "shah", "li"})
    EXPECT_LE(joint, handeye::held_out(input.setup, input.views, name).rms.translation_m) << name;
}

// Self-calibrated intrinsics are known to be 3.7 % off here; the factory's are given.
TEST(RealHandEye, Ur5eWithTheFactorysIntrinsics) {
  constexpr const char* set = "handeye/ur5e_checkerboard_sdu";
  GONIO_NEEDS_DATA(set);
  const tests::ScratchFolder folder;
  const auto pictures = files_of("handeye/ur5e_checkerboard_sdu/images", ".jpg");
  calibrate({"--checkerboard", "9x6", "--square", "21.5mm"}, pictures, folder);
  manifest::Document d = manifest::read_document(folder / "camera.json", {.allow_outside = true});
  manifest::Camera& camera = d.cameras.at("camera");
  camera.fx_px = 682.33544921875;
  camera.fy_px = 682.471923828125;
  camera.cx_px = 483.771453857422;
  camera.cy_px = 270.217803955078;
  camera.distortion = {{"k1", 0.183375015854836},
                       {"k2", -0.565327823162079},
                       {"p1", -1.45305e-4},
                       {"p2", 5.0213e-4},
                       {"k3", 0.508288383483887}};
  camera.sigma.clear();
  camera.covariance = {};
  write_file(folder / "factory.json", manifest::print_document(d, folder.path()));
  std::vector<int> lines;
  for (const auto& picture : pictures) {
    const std::string stem = std::filesystem::path(picture).stem().string();  // "0-17": line 17
    lines.push_back(std::stoi(stem.substr(2)));
  }
  const auto poses = picked_lines(tests::data("handeye/ur5e_checkerboard_sdu/40_poses_test.txt"), lines, folder);
  const tests::Ended ended = handeye(folder, {"--poses", poses, "--pose-format", "ur"}, "factory.json");
  ASSERT_EQ(ended.status, 0) << ended.err;
  const Found f = found(ended);
  EXPECT_LE(ratio_to_best(f.analysis), 1.0);
  EXPECT_LE(*f.mounting.scatter_m, 2.358e-3);
  EXPECT_LE(f.mounting.held_out->translation_m.value(), f.analysis.held_out_of("reprojection")->rms.translation_m);
  const Vec3 peer{0.010750, 0.009010, 0.059686}, mine = f.mounting.tool_from_camera->translation_m;
  EXPECT_LT(norm(mine - peer), 0.003);
  // The lens that is off turns the board, which is not the robot's noise: explain once took it for 5.3 mm, handeye
  // for 1.6.
  tests::expect_one_figure(tests::both_noises(handeye(folder, {"--poses", poses, "--pose-format", "ur"})), 0.02);
}

// ---- what people get wrong, on a small manifest of their own ----

std::string manifest_text(const std::string& images, const std::string& corners) {
  return R"({"gonio": 1, "boards": {"board": {"kind": "checkerboard", "inner_corners": [3, 3], "square_m": 0.05}},
 "cameras": {"camera": {"model": "pinhole", "width_px": 1000, "height_px": 800, "fx_px": 800, "fy_px": 800, "cx_px": 500, "cy_px": 400}},
 "images": [)" +
         images + R"(], "tables": {"corners": {"model": "camera", "camera": "camera", "board": "board",
 "columns": {"image": "", "corner": "1", "board_x_m": "m", "board_y_m": "m", "u_px": "px", "v_px": "px", "sigma_px": "px"},
 "observed": ["u_px", "v_px"], "sigma": ["sigma_px"], "rows": [)" +
         corners + "]}}}";
}

struct SmallSet {
  std::vector<std::string> ids{"a", "b", "c", "d"};
  bool pose_in_camera = true, same_pose = false;
  std::string write(const tests::ScratchFolder& folder, bool with_robot) const {
    std::string images, corners;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const double s = static_cast<double>(i);
      const Rigid<frame::Camera, frame::Board> pose{
          quaternion_of_rotation_vector({0.3 * std::sin(s), 0.3 * std::cos(2 * s), 0.4 * s}), {0.01 * s, -0.02, 0.5}};
      const auto tool = inverse(pose);
      const auto numbers = [](const Quaternion& q, Vec3 t) {
        char text[400];
        std::snprintf(text, sizeof text,
                      R"({"rotation": [%.15g, %.15g, %.15g, %.15g], "translation_m": [%.15g, %.15g, %.15g]})", q.w, q.x,
                      q.y, q.z, t.x, t.y, t.z);
        return std::string(text);
      };
      images +=
          (i > 0 ? ", " : "") + std::string(R"({"id": ")") + ids[i] + R"(", "camera": "camera", "board": "board")";
      if (pose_in_camera) images += R"(, "camera_from_board": )" + numbers(pose.rotation, pose.translation_m);
      if (with_robot && !same_pose) images += R"(, "base_from_tool": )" + numbers(tool.rotation, tool.translation_m);
      if (with_robot && same_pose)
        images += R"(, "base_from_tool": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, 0]})";
      images += "}";
      for (int k = 0; k < 9; ++k) {
        const Vec3 p = pose * Vec3{k % 3 * 0.05, static_cast<double>(k / 3) * 0.05, 0};
        char row[200];
        std::snprintf(row, sizeof row, R"(%s["%s", %d, %.3g, %.3g, %.15g, %.15g, 0.1])",
                      i + static_cast<std::size_t>(k) > 0 ? ", " : "", ids[i].c_str(), k, k % 3 * 0.05, k / 3 * 0.05,
                      800 * p.x / p.z + 500, 800 * p.y / p.z + 400);
        corners += row;
      }
    }
    write_file(folder / "camera.json", manifest_text(images, corners));
    return (folder / "camera.json").string();
  }
};

struct Refusal {
  int status;
  std::string line;
};
Refusal refusal(const tests::ScratchFolder& folder, const Words& options) {
  const tests::Ended ended = handeye(folder, options);
  EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
  return {ended.status, ended.err};
}

TEST(HandEyeRefusals, ASmallSetIsAcceptedAsItStands) {
  const tests::ScratchFolder folder;
  SmallSet{}.write(folder, true);
  const tests::Ended ended = handeye(folder, {"--html", (folder / "r.html").string()});
  EXPECT_EQ(ended.status, 0) << ended.err;
  const auto document = manifest::parse_document(ended.out, "out", folder.path(), {.allow_outside = true});
  const auto& mounting = document.mountings.at("camera");
  EXPECT_LT(norm(mounting.tool_from_camera->translation_m), 1e-6);
  EXPECT_EQ(document.frames.size(), 2U);
}

TEST(HandEyeRefusals, NoPoseOfTheRobot) {
  const tests::ScratchFolder folder;
  SmallSet{}.write(folder, false);
  const Refusal r = refusal(folder, {});
  EXPECT_EQ(r.status, 65);
  EXPECT_THAT(r.line, HasSubstr("#/images/0/base_from_tool: missing"));
}

TEST(HandEyeRefusals, NoPoseOfTheBoard) {
  const tests::ScratchFolder folder;
  SmallSet set;
  set.pose_in_camera = false;
  set.write(folder, true);
  const Refusal r = refusal(folder, {});
  EXPECT_EQ(r.status, 65);
  EXPECT_THAT(r.line, HasSubstr("0 poses with a board"));
}

TEST(HandEyeRefusals, OnePose) {
  const tests::ScratchFolder folder;
  SmallSet set;
  set.ids = {"a"};
  set.write(folder, true);
  const Refusal r = refusal(folder, {});
  EXPECT_EQ(r.status, 65);
  EXPECT_THAT(r.line, HasSubstr("1 pose with a board (at least 3 are needed)"));
}

TEST(HandEyeRefusals, PosesThatAreAllTheSame) {
  const tests::ScratchFolder folder;
  SmallSet set;
  set.same_pose = true;
  set.write(folder, true);
  const Refusal r = refusal(folder, {});
  EXPECT_EQ(r.status, 65);
  EXPECT_THAT(r.line, HasSubstr("all the same"));
}

TEST(HandEyeRefusals, PoseLists) {
  const tests::ScratchFolder folder;
  SmallSet{}.write(folder, false);
  const auto list = [&](const std::string& text, const std::string& format) {
    write_file(folder / "p.txt", text);
    return refusal(folder, {"--poses", (folder / "p.txt").string(), "--pose-format", format});
  };
  const Refusal shorter = list("0 0 0 0 0 0\n0 0 1 0 0 1\n", "ur");
  EXPECT_EQ(shorter.status, 65);
  EXPECT_THAT(shorter.line, HasSubstr("2 poses for 4 images"));
  std::string left;
  for (int k = 0; k < 4; ++k) left += "1 0 0 0.1  0 1 0 0.2  0 0 -1 0.3  0 0 0 1\n";
  EXPECT_EQ(list(left, "matrix").status, 65);
  std::string degrees;
  for (int k = 0; k < 4; ++k) degrees += "0.1 0.2 0.3 90 0 " + std::to_string(45 * k) + "\n";
  EXPECT_EQ(list(degrees, "ur").status, 65);
  EXPECT_EQ(list("0 0 0 0 0 0\n", "universal").status, 64);
}

TEST(HandEyeRefusals, TwoWaysOfGivingPoses) {
  const tests::ScratchFolder folder;
  SmallSet{}.write(folder, true);
  write_file(folder / "p.txt", "0 0 0 0 0 0\n0 0 1 0 0 1\n0 0 1 0 1 0\n0 0 1 1 0 0\n");
  const Refusal r = refusal(folder, {"--poses", (folder / "p.txt").string(), "--pose-format", "ur"});
  EXPECT_EQ(r.status, 65);
  EXPECT_THAT(r.line, HasSubstr("stands beside --poses"));
}

}  // namespace
}  // namespace gonio::robot
