// What calib-charuco says about its own result on real photographs.
#include <gmock/gmock.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "process.h"

namespace gonio::camera::tests {
namespace {

using gonio::tests::Process;
using gonio::tests::run;

std::vector<std::string> pictures(const char* set, const std::string& prefix) {
  std::vector<std::string> list;
  for (const auto& entry : std::filesystem::directory_iterator(gonio::tests::data(set))) {
    const std::string name = entry.path().filename().string(), extension = entry.path().extension().string();
    if (name.starts_with(prefix) && (extension == ".png" || extension == ".jpg")) list.push_back(entry.path().string());
  }
  std::ranges::sort(list);
  return list;
}

Process::Words call(Process::Words words, const std::vector<std::string>& files) {
  words.insert(words.begin(), "calib-charuco");
  words.insert(words.end(), files.begin(), files.end());
  return words;
}

constexpr const char* checkerboard_set = "calibration/opencv_stereo_checkerboard";

TEST(QualityOfACalibration, IsSaidInNumbersMapsAndAPage) {
  GONIO_NEEDS_DATA(checkerboard_set);
  const gonio::tests::ScratchFolder folder;
  const auto ended =
      run(call({"--checkerboard", "9x6", "--square", "25mm", "--distance", "0.3m", "--distance", "1m", "--out", "o"},
               pictures(checkerboard_set, "left")),
          folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, testing::HasSubstr("This calibration predicts within"));
  const auto document = manifest::parse_document(ended.out, "out", folder.path(), {.allow_outside = true});
  const manifest::CameraQuality& q = document.cameras.at("camera").quality.value();
  EXPECT_EQ(q.distances_m, (std::vector<double>{0.3, 1}));
  EXPECT_GT(q.predicts_within_px.value(), 0.1);
  EXPECT_LT(q.predicts_within_px.value(), 10);
  EXPECT_TRUE(q.halves_agree.value());
  EXPECT_LT(q.halves_differ_px.value(), 3 * q.halves_expected_px.value());
  EXPECT_NEAR(q.coverage.value(), 0.43, 0.05);
  EXPECT_EQ(q.next.size(), 3u);
  const io::Image map = io::read_picture(folder / "o/projection-sigma.exr");
  EXPECT_EQ(map.channels, (std::vector<std::string>{"radius_95", "sigma_u", "sigma_v"}));
  EXPECT_EQ(map.width, 160);
  // In the middle, where the boards were, it knows far more than in the corners.
  EXPECT_LT(10 * map.at(80, 60, 0), map.at(0, 0, 0));
  for (const char* name : {"projection-sigma-2.exr", "projection-sigma.png", "coverage.png"})
    EXPECT_TRUE(std::filesystem::exists(folder / "o" / name)) << name;
  EXPECT_THAT(read_file(folder / "o/calibration.html"), testing::HasSubstr("What to photograph next"));
}

// Eight photographs of a paper board: residuals of half a pixel that are no noise.
TEST(QualityOfACalibration, HalvesOfABentPaperBoardDisagree) {
  GONIO_NEEDS_DATA("calibration/charuco_realsense_mit");
  const auto ended = run(call({"--charuco", "7x5", "--square", "30mm", "--marker", "22mm", "--dictionary", "4X4_50"},
                              pictures("calibration/charuco_realsense_mit", "calib")));
  EXPECT_THAT(ended.err, testing::HasSubstr("something is not modelled"));
  const auto document = manifest::parse_document(ended.out, "out", ".", {.allow_outside = true});
  EXPECT_FALSE(document.cameras.at("camera").quality.value().halves_agree.value());
}

TEST(QualityOfACalibration, IsLeftOutOnRequestAndRefusesWhatIsNoDistance) {
  GONIO_NEEDS_DATA(checkerboard_set);
  const auto files = pictures(checkerboard_set, "left0");
  const Process::Words board{"--checkerboard", "9x6", "--square", "25mm"};
  auto words = board;
  words.push_back("--no-quality");
  const auto ended = run(call(words, files));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_FALSE(manifest::parse_document(ended.out, "out", ".", {.allow_outside = true}).cameras.at("camera").quality);
  for (const char* wrong : {"0.5", "2deg", "-1m"}) {
    words = board;
    words.insert(words.end(), {"--distance", wrong});
    const auto refused = run(call(words, files));
    EXPECT_EQ(refused.status, 64) << wrong;
    EXPECT_THAT(refused.err, testing::HasSubstr("--distance")) << wrong;
  }
}

}  // namespace
}  // namespace gonio::camera::tests
