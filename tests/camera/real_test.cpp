// The program on real photographs, against what peers found in the same files (their SOURCE.md), and on what people get
// wrong.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "camera/corner_table.h"
#include "data.h"
#include "manifest/document.h"
#include "process.h"

namespace gonio::camera {
namespace {

using Words = tests::Process::Words;

std::vector<std::string> pictures(const char* set, const std::string& prefix) {
  std::vector<std::string> list;
  for (const auto& entry : std::filesystem::directory_iterator(tests::data(set))) {
    const std::string name = entry.path().filename().string(), extension = entry.path().extension().string();
    if (name.starts_with(prefix) && (extension == ".png" || extension == ".jpg")) list.push_back(entry.path().string());
  }
  std::ranges::sort(list);
  return list;
}

Words call(Words options, const std::vector<std::string>& files) {
  Words words{"calib-charuco"};
  words.insert(words.end(), options.begin(), options.end());
  words.insert(words.end(), files.begin(), files.end());
  return words;
}

manifest::Document document_of(const tests::Ended& ended) {
  EXPECT_EQ(ended.status, 0) << ended.err;
  return manifest::parse_document(ended.out, "out", ".", {.allow_outside = true});
}

constexpr const char* checkerboard_set = "calibration/opencv_stereo_checkerboard";
const Words checkerboard{"--checkerboard", "9x6", "--square", "25mm"};
const Words charuco_mit{"--charuco", "7x5", "--square", "30mm", "--marker", "22mm", "--dictionary", "4X4_50"};

TEST(RealPhotographs, LeftCheckerboard) {
  GONIO_NEEDS_DATA(checkerboard_set);
  const auto document = document_of(tests::run(call(checkerboard, pictures(checkerboard_set, "left"))));
  const manifest::Camera& camera = document.cameras.at("camera");
  EXPECT_NEAR(camera.fx_px.scalar(), 532.8, 3);
  EXPECT_NEAR(camera.fy_px.scalar(), 532.9, 3);
  EXPECT_NEAR(camera.cx_px.scalar(), 342.5, 3);
  EXPECT_NEAR(camera.cy_px.scalar(), 233.9, 3);
  EXPECT_LE(camera.rms_px.value(), 0.20);
  for (const char* name : {"fx_px", "fy_px", "cx_px", "cy_px", "k1", "k2", "p1", "p2", "k3"}) {
    ASSERT_TRUE(camera.sigma.contains(name)) << name;
    EXPECT_GT(camera.sigma.at(name).at(0), 0) << name;
  }
  EXPECT_EQ(camera.covariance.find("values")->as_array().size(), 9U);
  ASSERT_EQ(document.images.size(), 13U);
  for (const manifest::ImageEntry& image : document.images) {
    EXPECT_EQ(image.weight.value(), 1) << image.id;
    EXPECT_TRUE(image.camera_from_board->sigma) << image.id;
    EXPECT_GT(image.camera_from_board->translation_m.z, 0.2) << image.id;
  }
  const CornerTable table = read_corners(document, "corners");
  ASSERT_EQ(table.images.size(), 13U);
  for (const ImageCorners& group : table.images) EXPECT_EQ(group.corners.size(), 54U);
}

TEST(RealPhotographs, RealsenseCharuco) {
  GONIO_NEEDS_DATA("calibration/charuco_realsense_mit");
  const auto document =
      document_of(tests::run(call(charuco_mit, pictures("calibration/charuco_realsense_mit", "calib"))));
  const manifest::Camera& camera = document.cameras.at("camera");
  EXPECT_LE(camera.rms_px.value(), 0.57);
  EXPECT_NEAR(camera.fx_px.scalar(), 898.2, 4);
  EXPECT_NEAR(camera.fy_px.scalar(), 901.3, 4);
  EXPECT_FALSE(document.boards.at("board").legacy_layout);  // five rows: there is one layout only
}

TEST(RealPhotographs, FlirCharucoWithTheLegacyLayout) {
  GONIO_NEEDS_DATA("calibration/charuco_flir_left");
  const Words options{"--charuco", "25x18", "--square", "7.5mm", "--marker", "5.6mm", "--dictionary", "DICT_5X5_1000"};
  const auto document = document_of(tests::run(call(options, pictures("calibration/charuco_flir_left", ""))));
  EXPECT_EQ(document.boards.at("board").legacy_layout, true);
  const manifest::Camera& camera = document.cameras.at("camera");
  EXPECT_LE(camera.rms_px.value(), 0.17);
  EXPECT_NEAR(camera.fx_px.scalar(), 3742, 10);
  EXPECT_NEAR(camera.fy_px.scalar(), 3743, 10);
}

TEST(Program, SameDocumentWhateverTheNumberOfThreads) {
  GONIO_NEEDS_DATA(checkerboard_set);
  std::vector<std::string> ids;
  for (const char* threads : {"1", "3"}) {
    Words options = checkerboard;
    options.insert(options.end(), {"--threads", threads});
    ids.push_back(manifest::content_id(document_of(tests::run(call(options, pictures(checkerboard_set, "left0"))))));
  }
  EXPECT_EQ(ids[0], ids[1]);
}

TEST(Program, ReadsAManifestAndWritesTheTableBesideIt) {
  GONIO_NEEDS_DATA(checkerboard_set);
  const tests::ScratchFolder folder;
  std::string images, files;
  for (const char* name : {"left01", "left02", "left03", "left05", "left06", "left07", "left08", "left12", "left14"}) {
    std::filesystem::copy_file(tests::data(checkerboard_set) / (std::string(name) + ".jpg"),
                               folder / (std::string(name) + ".jpg"));
    files += (files.empty() ? "\"" : ", \"") + std::string(name) + "\": {\"path\": \"" + name + ".jpg\"}";
    images += std::string(images.empty() ? "" : ", ") + "{\"id\": \"" + name + "\", \"file\": \"" + name +
              "\", \"x-note\": 1}";
  }
  const std::string manifest =
      "{\"gonio\": 1, \"files\": {" + files +
      "}, \"boards\": {\"b\": {\"kind\": \"checkerboard\", \"inner_corners\": [9, 6], \"square_m\": 0.025}}, "
      "\"cameras\": {\"c\": {\"model\": \"pinhole\"}}, \"images\": [" +
      images + "]}";
  write_file(folder / "board.json", manifest);
  const tests::Ended ended = tests::run({"calib-charuco", "-i", "board.json", "--out", "o"}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  const auto document = manifest::parse_document(ended.out, "out", folder.path());
  EXPECT_EQ(document.cameras.at("c").model, "pinhole");
  EXPECT_GT(document.cameras.at("c").rms_px.value(), 0.5);  // this lens is no pinhole
  EXPECT_THAT(ended.out, testing::HasSubstr("x-note"));
  EXPECT_TRUE(std::filesystem::exists(folder / "o/corners.csv"));
  const CornerTable table = read_corners(document, "corners");
  EXPECT_EQ(table.camera, "c");
  EXPECT_EQ(table.board, "b");
  EXPECT_EQ(table.images.size(), 9U);
}

struct Mistake {
  Words options;
  int status;
  std::string words;
};

TEST(Program, WhatPeopleGetWrongIsSaidInOneLine) {
  GONIO_NEEDS_DATA(checkerboard_set);
  const std::vector<std::string> few{(tests::data(checkerboard_set) / "left01.jpg").string(),
                                     (tests::data(checkerboard_set) / "left02.jpg").string()};
  const Mistake mistakes[] = {
      {{"--checkerboard", "10x7", "--square", "25mm"}, 65, "9 x 6 inner corners"},
      {{"--checkerboard", "9x6", "--square", "-25mm"}, 64, "--square"},
      {{"--checkerboard", "9x6", "--square", "25"}, 64, "unit"},
      {{"--checkerboard", "nine", "--square", "25mm"}, 64, "9x6"},
      {{"--checkerboard", "9x6"}, 64, "--square"},
      {{}, 64, "--checkerboard"},
      {{"--checkerboard", "9x6", "--square", "25mm", "/nowhere/a.jpg"}, 66, "/nowhere/a.jpg"},
      {{"--charuco", "7x5", "--square", "30mm", "--marker", "40mm", "--dictionary", "4X4_50"}, 64, "marker"},
      {{"--charuco", "7x5", "--square", "30mm", "--marker", "20mm", "--dictionary", "4Y4_50"}, 64, "4Y4_50"},
      {{"--checkerboard", "9x6", "--square", "25mm"}, 2, "2 views show the board"},
  };
  for (const Mistake& mistake : mistakes) {
    Words options = mistake.options;
    options.insert(options.begin(), {"--log-level", "error"});
    const tests::Ended ended = tests::run(call(options, few));
    EXPECT_EQ(ended.status, mistake.status) << ended.err;
    EXPECT_THAT(ended.err, testing::HasSubstr(mistake.words));
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
    EXPECT_EQ(ended.out.empty(), mistake.status != 2);
  }
}

TEST(Program, NamesTheDictionaryThatThePicturesShow) {
  GONIO_NEEDS_DATA("calibration/charuco_realsense_mit");
  Words options = charuco_mit;
  options.back() = "6X6_50";
  const tests::Ended wrong = tests::run(call(options, pictures("calibration/charuco_realsense_mit", "calib_00")));
  EXPECT_EQ(wrong.status, 65);
  EXPECT_THAT(wrong.err, testing::HasSubstr("17 markers of 4X4_50"));
  options = charuco_mit;
  options[1] = "5x5";
  const tests::Ended small = tests::run(call(options, pictures("calibration/charuco_realsense_mit", "calib_00")));
  EXPECT_EQ(small.status, 2);
  EXPECT_THAT(small.err, testing::HasSubstr("larger than described"));
}

TEST(Program, DrawsABoard) {
  const tests::ScratchFolder folder;
  const tests::Ended ended = tests::run({"calib-charuco", "--charuco", "7x5", "--square", "30mm", "--marker", "22mm",
                                         "--dictionary", "4X4_50", "--draw", "b.pdf"},
                                        folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(read_file(folder / "b.pdf").starts_with("%PDF-1.4"));
  const auto document = manifest::parse_document(ended.out, "out", folder.path());
  EXPECT_EQ(document.boards.at("board").squares, (std::vector<int>{7, 5}));
  EXPECT_EQ(tests::run({"calib-charuco", "--charuco", "7x5", "--square", "60mm", "--marker", "22mm", "--dictionary",
                        "4X4_50", "--draw", "b.pdf"},
                       folder.path())
                .status,
            64);
}

}  // namespace
}  // namespace gonio::camera
