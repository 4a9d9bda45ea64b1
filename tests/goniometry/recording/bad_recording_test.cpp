// Recordings that cannot be reduced end with one line: where, what, and what to do.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "base/error.h"
#include "camera/intrinsics.h"
#include "data.h"
#include "light/irradiance.h"
#include "manifest/sections/file.h"
#include "manifest/sections/flat_patch.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "recordings.h"

namespace gonio::goniometry {
namespace {

using tests::direction;

// Three pictures of an even grey plate and a tile on it, without noise.
class BadRecordingTest : public testing::Test {
 protected:
  BadRecordingTest() {
    d_.folder = folder_.path();
    d_.name = "recording.json";
    camera::enter_pinhole(d_, "camera", 48, 48, 700);
    const Vec3 at = direction(25 * degree, 0) * 0.5;
    d_.lights["lamp"].parameters = {{"position_m", std::vector<double>{at.x, at.y, at.z}}, {"watt_per_sr", 1.0}};
    add_patch("sample", -0.006);
    add_patch("tile", 0.006);
    d_.goniometer["sample"].tile = "tile";
    d_.goniometer["tile"].reflectance = {0.98};
    for (int i = 0; i < 3; ++i) {
      tests::add_image(d_, "view-" + std::to_string(i), {"lamp", (10 + 15 * i) * degree, 1.0 + i}, 0.5);
      write(i, 48, 48, 1, 1);
    }
  }
  void add_patch(const std::string& name, double x_m) {
    manifest::FlatPatch& patch = d_.goniometer[name];
    patch.world_from_sample.emplace().translation_m = {x_m, 0, 0};
    patch.radius_m = 0.005;
  }
  // Radiance `sample` where x < 0, else `tile`: the border's image is a line through the middle of the picture.
  void write(int i, int width, int height, double sample, double tile, float spoil = 0) {
    io::Image picture(width, height, {"R", "G", "B"});
    const camera::CameraModel camera(*find_camera(d_, "camera"), "camera");
    const auto& pose = *d_.images[i].world_from_camera;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Vec3 ray = pose.rotate(camera.ray({1.0 * x, 1.0 * y}).direction);
        const double at = pose.translation_m.x - ray.x * pose.translation_m.z / ray.z;
        for (int c = 0; c < 3; ++c) picture.at(x, y, c) = (at < 0 ? sample : tile) + spoil;
      }
    const auto path = folder_ / ("view-" + std::to_string(i) + "-" + std::to_string(++written_) + ".exr");
    io::write_picture(path, picture);
    d_.images[i].file = manifest::add_file(d_, path, "f" + std::to_string(written_));
  }
  void write_all(double sample, double tile, float spoil = 0) {
    for (int i = 0; i < 3; ++i) write(i, 48, 48, sample, tile, spoil);
  }
  void expect_refused(const std::string& where, const std::string& what, Exit code = Exit::data) {
    try {
      reduce(d_);
      ADD_FAILURE() << "not refused: " << what;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code);
      EXPECT_NE(error.place().find(where), std::string::npos) << error.what();
      EXPECT_NE(error.problem().find(what), std::string::npos) << error.what();
      EXPECT_FALSE(error.remedy().empty() && code == Exit::data) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
  manifest::Document d_;
  tests::ScratchFolder folder_;
  int written_ = 0;
};

TEST_F(BadRecordingTest, TheGoodOneIsReduced) {
  write_all(0.5, 1);
  const Reduced reduced = reduce(d_);
  ASSERT_EQ(reduced.samples.rows(), 3u);
  // The pictures are even, the irradiance is not: tile and sample see the lamp at slightly other distances.
  const Vec3 lamp = d_.lights["lamp"].parameters["position_m"].vector();
  const auto arrives = [&](double x_m) { return light::point_irradiance({1, 1, 1}, lamp, {x_m, 0, 0}, {0, 0, 1}).x; };
  const double expected = 0.5 * 0.98 / pi * arrives(0.006) / arrives(-0.006);
  for (const double f : reduced.samples.f) EXPECT_NEAR(f / expected, 1, 1e-3);
}

TEST_F(BadRecordingTest, NoSection) {
  d_.goniometer.clear();
  expect_refused("#/goniometer", "is missing");
}
TEST_F(BadRecordingTest, PoseOfTheSampleMissing) {
  d_.goniometer["sample"].world_from_sample.reset();
  expect_refused("#/goniometer/sample/world_from_sample", "is missing");
}
TEST_F(BadRecordingTest, PoseOfACameraMissing) {
  d_.images[1].world_from_camera.reset();
  expect_refused("#/images/1/world_from_camera", "is missing");
}
TEST_F(BadRecordingTest, NoFileAtAll) {
  for (auto& image : d_.images) image.file.clear();
  expect_refused("#/goniometer/sample", "no image that has a recording");
  d_.goniometer["sample"].images = {"view-0"};
  expect_refused("#/images/0", "has no recording");
}
TEST_F(BadRecordingTest, PictureFileGone) {
  std::filesystem::remove(folder_.path() / d_.files[d_.images[2].file].path);
  expect_refused("#/files/", "cannot be read", Exit::no_input);
}
TEST_F(BadRecordingTest, SizeDiffersFromTheCameras) {
  write(1, 40, 48, 0.5, 1);
  expect_refused("#/images/1", "40 x 48 pixels, its camera 48 x 48");
}
TEST_F(BadRecordingTest, ExposureMissing) {
  d_.goniometer["sample"].values = "exposure";
  expect_refused("#/images/0/exposure_s", "is missing");
}
TEST_F(BadRecordingTest, NeitherTileNorCalibratedLight) {
  d_.goniometer["sample"].tile.clear();
  d_.lights["lamp"].parameters["watt_per_sr"].free = true;
  expect_refused("#/lights/lamp/watt_per_sr", "no white tile");
}
TEST_F(BadRecordingTest, ATileThatStatesNothing) {
  d_.goniometer["tile"].reflectance.clear();
  expect_refused("#/goniometer/tile", "nothing says what it reflects");
}
TEST_F(BadRecordingTest, SeveralSamplesAndTilesAlone) {
  add_patch("other", 0);
  expect_refused("#/goniometer", "several samples: other, sample");
  d_.goniometer.erase("other");
  d_.goniometer.erase("sample");
  expect_refused("#/goniometer", "white tiles alone");
}
TEST_F(BadRecordingTest, NoLights) {
  d_.lights.clear();
  for (auto& image : d_.images) image.light.clear();
  expect_refused("#/lights", "is empty");
}
TEST_F(BadRecordingTest, LightFromEverywhere) {
  d_.mechanisms["light.ambient"].parameters["radiance"] = manifest::Parameter(std::vector<double>{0.1, 0.1, 0.1});
  try {
    reduce(d_);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(error.place().find("light.ambient"), std::string::npos) << error.what();
  }
}
TEST_F(BadRecordingTest, PatchOutsideEveryImage) {
  d_.goniometer["sample"].world_from_sample->translation_m = {0.2, 0, 0};
  expect_refused("#/goniometer/sample", "3: a part of the patch is outside the picture");
}
TEST_F(BadRecordingTest, SampleThatFacesAway) {
  d_.goniometer["sample"].world_from_sample->rotation = quaternion_of_rotation_vector({pi, 0, 0});
  expect_refused("#/goniometer/sample", "below the patch's horizon");
}
TEST_F(BadRecordingTest, PicturesWithoutNumbers) {
  write_all(1, 1, std::nanf(""));
  expect_refused("#/goniometer/sample", "are no numbers");
}
TEST_F(BadRecordingTest, ATileAThousandTimesBrighter) {
  write_all(0.0005, 1);
  expect_refused("#/goniometer/tile", "times brighter than the sample");
}
TEST_F(BadRecordingTest, ATileAThousandTimesDarker) {
  write_all(2000, 1);
  expect_refused("#/goniometer/tile", "times darker than the sample");
}
TEST_F(BadRecordingTest, ABlackTile) {
  write_all(0.5, 0);
  expect_refused("#/goniometer/sample", "the white tile cannot be read");
}
TEST_F(BadRecordingTest, OneBandAmongThree) {
  io::Image grey(48, 48, {"Y"});
  std::ranges::fill(grey.data, 0.5f);
  io::write_picture(folder_ / "grey.exr", grey);
  d_.images[2].file = manifest::add_file(d_, folder_ / "grey.exr", "grey");
  expect_refused("#/images/2", "has 1 channels");
}
TEST_F(BadRecordingTest, SpoiledNumbersOfThePatch) {
  d_.goniometer["sample"].radius_m.reset();
  d_.goniometer["sample"].polygon_m = {{0, 0}, {0.01, 0}};
  expect_refused("#/goniometer/sample/polygon_m", "has 2 corners");
  d_.goniometer["sample"].polygon_m = {{0, 0}, {0.01, 0}, {0.02, 0}};
  expect_refused("#/goniometer/sample/polygon_m", "no area");
}
TEST_F(BadRecordingTest, TooFewPixels) {
  d_.goniometer["sample"].radius_m = 0.0015;
  expect_refused("#/goniometer/sample", "too few pixels");
}

}  // namespace
}  // namespace gonio::goniometry
