// Undistortion behind a mosaic of filters: no filter's value enters another's, and every pixel holds what its filter
// would have read at the place where its own ray meets the source.
#include <gmock/gmock.h>

#include <cmath>

#include "base/error.h"
#include "camera/mosaic.h"
#include "camera/undistort.h"
#include "manifest/sections/camera.h"

namespace gonio::camera {
namespace {

manifest::Camera bent() {
  manifest::Camera c;
  c.model = "radial-tangential";
  c.width_px = 161;  // an odd number of columns: the filters' lattices differ in size
  c.height_px = 120;
  c.fx_px = 133.2, c.fy_px = 133.5, c.cx_px = 85.5, c.cy_px = 58.3;
  c.distortion["k1"] = -0.280882;
  c.distortion["k2"] = 0.025178;
  c.distortion["p1"] = 0.001217;
  c.mosaic = "RGGB";
  return c;
}

// `of(filter, x, y)` over the pixels; filters 0 .. 3 row by row.
template <class Of>
io::Image mosaic(const manifest::Camera& camera, const Of& of) {
  io::Image image(camera.width_px, camera.height_px, {"Y"});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) image.at(x, y, 0) = static_cast<float>(of(2 * (y % 2) + x % 2, x, y));
  return image;
}

Undistorted developed(const io::Image& source, const manifest::Camera& to, Resampling resampling = {}) {
  resampling.pitch = 2;
  return undistort(source, {}, CameraModel(bent(), "t"), CameraModel(to, "t"), resampling);
}

constexpr std::array<float, 4> readings = {0.1f, 0.7f, 0.31f, 0.93f};

TEST(UndistortMosaic, WhatIsConstantPerFilterStaysSoExactly) {
  const io::Image source = mosaic(bent(), [](int filter, int, int) { return readings[filter]; });
  for (const Kernel kernel : {Kernel::keys, Kernel::mitchell, Kernel::lanczos3})
    for (const Keep keep : {Keep::valid, Keep::all, Keep::same})
      for (const double scale : {1.0, 0.6, 1.7}) {
        SCOPED_TRACE(static_cast<int>(kernel) * 100 + static_cast<int>(keep) * 10 + scale);
        const manifest::Camera to =
            pinhole_for(bent(), {.keep = keep, .scale = scale, .kernel = kernel, .pitch = 2}, "t");
        EXPECT_EQ(to.mosaic, "RGGB");
        const Undistorted result = developed(source, to, {.kernel = kernel, .stretch = std::max(1.0, 1 / scale)});
        const io::Image& picture = result.picture;
        std::size_t valid = 0;
        for (int y = 0; y < picture.height; ++y)
          for (int x = 0; x < picture.width; ++x) {
            const bool counts = result.valid[static_cast<std::size_t>(y * picture.width + x)] != 0;
            valid += counts;
            if (!counts) continue;
            ASSERT_EQ(picture.at(x, y, 0), readings[2 * (y % 2) + x % 2]) << x << " " << y;
          }
        if (keep == Keep::valid) {
          EXPECT_EQ(valid, picture.pixels());
        } else {
          EXPECT_GT(valid, picture.pixels() / 3);
        }
      }
}

// A ramp, another one for each filter. Keys and Lanczos reproduce it to the rounding of the float, 1e-6 of full scale:
// the pixel (x, y) holds its own filter's ramp at the point where its ray meets the source, to 1e-5 px.
TEST(UndistortMosaic, ARampIsReadWhereTheRayMeetsIt) {
  const auto ramp = [](int filter, double x, double y) {
    return 0.05 + 0.1 * filter + (0.003 + 0.0005 * filter) * x + (0.002 - 0.0003 * filter) * y;
  };
  const io::Image source = mosaic(bent(), ramp);
  for (const Kernel kernel : {Kernel::keys, Kernel::lanczos3}) {
    const manifest::Camera to = pinhole_for(bent(), {.kernel = kernel, .pitch = 2}, "t");
    const Undistorted result = developed(source, to, {.kernel = kernel});
    const CameraModel lens(bent(), "t"), model(to, "t");
    for (int y = 0; y < to.height_px; ++y)
      for (int x = 0; x < to.width_px; ++x) {
        const auto at = lens.project(model.ray({x * 1.0, y * 1.0}).direction);
        ASSERT_NEAR(result.picture.at(x, y, 0), ramp(2 * (y % 2) + x % 2, at->x, at->y), 1e-6) << x << " " << y;
      }
  }
}

// A wave of 24 px: keys, exact for quadratics, errs by less than 1 % of its amplitude on lattices of two pixels.
TEST(UndistortMosaic, ASmoothPictureIsRightToAHundredth) {
  const auto wave = [](int filter, double x, double y) {
    return 0.5 + 0.3 * std::sin(2 * pi * (x + 0.4 * y) / 24 + filter);
  };
  const manifest::Camera to = pinhole_for(bent(), {.pitch = 2}, "t");
  const Undistorted result = developed(mosaic(bent(), wave), to);
  const CameraModel lens(bent(), "t"), model(to, "t");
  double worst = 0;
  for (int y = 0; y < to.height_px; ++y)
    for (int x = 0; x < to.width_px; ++x) {
      const auto at = lens.project(model.ray({x * 1.0, y * 1.0}).direction);
      worst = std::max(worst, std::abs(result.picture.at(x, y, 0) - wave(2 * (y % 2) + x % 2, at->x, at->y)));
    }
  EXPECT_LT(worst, 0.01 * 0.3);
}

TEST(UndistortMosaic, WithoutDistortionNoBitChanges) {
  manifest::Camera plain;
  plain.width_px = 31, plain.height_px = 20;
  plain.fx_px = plain.fy_px = 60.0;
  plain.cx_px = 15, plain.cy_px = 9;
  plain.mosaic = "polarizers";
  const io::Image source = mosaic(plain, [](int filter, int x, int y) { return 0.1 * filter + 0.37 * ((x * y) % 7); });
  const manifest::Camera to = pinhole_for(plain, {.pitch = 2}, "t");
  EXPECT_EQ(to.mosaic, "polarizers");
  const Undistorted result =
      undistort(source, {}, CameraModel(plain, "t"), CameraModel(to, "t"), Resampling{.pitch = 2});
  EXPECT_EQ(result.picture.data, source.data);
  EXPECT_EQ(std::ranges::count(result.valid, 0), 0);
}

TEST(UndistortMosaic, ASaturatedSampleSpoilsItsOwnFilterAlone) {
  io::Image source = mosaic(bent(), [](int filter, int, int) { return readings[filter]; });
  std::vector<std::uint8_t> good(source.pixels(), 1);
  good[60 * 161 + 80] = 0;  // filter 0
  const manifest::Camera to = pinhole_for(bent(), {.pitch = 2}, "t");
  const Undistorted result =
      undistort(source, good, CameraModel(bent(), "t"), CameraModel(to, "t"), Resampling{.pitch = 2});
  std::array<int, 4> spoilt{};
  for (int y = 0; y < to.height_px; ++y)
    for (int x = 0; x < to.width_px; ++x)
      spoilt[2 * (y % 2) + x % 2] += !result.valid[static_cast<std::size_t>(y * to.width_px + x)];
  EXPECT_GE(spoilt[0], 4);
  EXPECT_THAT(std::vector<int>(spoilt.begin() + 1, spoilt.end()), testing::Each(0));
}

TEST(UndistortMosaic, PatternsThatAreNotKnown) {
  EXPECT_EQ(filter_pitch("", "t"), 1);
  EXPECT_EQ(filter_pitch("GBRG", "t"), 2);
  EXPECT_EQ(filter_pitch("polarizers", "t"), 2);
  EXPECT_THROW(filter_pitch("RGBW", "t"), Error);
}

}  // namespace
}  // namespace gonio::camera
