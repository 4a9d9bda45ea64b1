// Pictures as height maps for explain: what their numbers mean is said beside them and remembered in the manifest.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "explain/heights/heights_problem.h"
#include "explain/tables/quick_table.h"
#include "io/exr.h"
#include "manifest/document.h"

namespace gonio::explain::tests {
namespace {

using tables::HeightMapKind;
using testing::HasSubstr;

class HeightPictures : public testing::Test {
 protected:
  std::filesystem::path tiff(const std::string& name, const cv::Mat& picture) {
    cv::imwrite((folder_ / name).string(), picture);
    return folder_ / name;
  }
  // As explain reads the manifest that it has written.
  io::HeightMap map_of(const manifest::Document& document) {
    const std::string text = manifest::print_document(document, folder_.path());
    return heights_inputs(manifest::parse_document(text, "again", folder_.path())).at(0).map;
  }
  gonio::tests::ScratchFolder folder_;
};

TEST_F(HeightPictures, TiffOfFloatsAndOfCodes) {
  cv::Mat floats(5, 7, CV_32F), codes(5, 7, CV_16U);
  for (int i = 0; i < 35; ++i) {
    floats.at<float>(i / 7, i % 7) = static_cast<float>(i) * 0.25f - 3;
    codes.at<std::uint16_t>(i / 7, i % 7) = static_cast<std::uint16_t>(1800 * i);
  }
  const auto a = tiff("a.tif", floats), b = tiff("b.tif", codes);
  EXPECT_EQ(tables::height_map_kind(a), HeightMapKind::picture);
  const io::HeightMap f =
      map_of(tables::height_map_document(a, {.step_x_m = 1.6e-6, .step_y_m = 1.9e-6, .unit_m = 1e-6}));
  EXPECT_EQ(f.width, 7u);
  EXPECT_DOUBLE_EQ(f.step_x_m, 1.6e-6);
  EXPECT_DOUBLE_EQ(f.step_y_m, 1.9e-6);
  EXPECT_NEAR(f.at(6, 4), 5.5e-6, 1e-15);
  const io::HeightMap c =
      map_of(tables::height_map_document(b, {.step_x_m = 1e-6, .step_y_m = 1e-6, .unit_m = 0.1e-9}));
  EXPECT_NEAR(c.at(6, 4), 34 * 1800 * 0.1e-9, 1e-18);
}

TEST_F(HeightPictures, AnExrThatSaysItsStepNeedsNothing) {
  io::HeightMap map{4, 3, 2e-6, 3e-6, std::vector<double>(12, 1e-6)};
  io::write_height_map(folder_ / "m.exr", map);
  EXPECT_EQ(tables::height_map_kind(folder_ / "m.exr"), HeightMapKind::picture);
  EXPECT_NEAR(map_of(tables::height_map_document(folder_ / "m.exr")).step_y_m, 3e-6, 1e-18);
}

TEST_F(HeightPictures, WhatIsNotSaidIsAskedForByTheNameOfItsOption) {
  const auto file = tiff("m.tif", cv::Mat(3, 3, CV_32F, cv::Scalar(1)));
  const auto refusal = [&](const io::HeightPicture& picture) {
    try {
      tables::height_map_document(file, picture);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(refusal({}), HasSubstr("--unit um"));
  EXPECT_THAT(refusal({.unit_m = 1e-6}), HasSubstr("--step 1.6um"));
  write_file(file, read_file(file).substr(0, 20));
  EXPECT_NE(refusal({.step_x_m = 1e-6, .step_y_m = 1e-6, .unit_m = 1e-6}), "none");
  EXPECT_EQ(tables::height_map_kind(folder_ / "none.tif"), HeightMapKind::none);
}

}  // namespace
}  // namespace gonio::explain::tests
