// Undistortion against pictures that are known as functions: what a lens bends comes out straight, points come out
// where the pinhole sees them, kernels reproduce the polynomials that they promise, and nothing invalid is called
// valid.
#include "camera/undistort.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "manifest/sections/camera.h"

namespace gonio::camera {
namespace {

using Scene = std::function<double(double x, double y)>;  // on the plane z = 1

manifest::Camera barrel() {  // the left camera of the OpenCV stereo pair at half its size: 10 px at the corners
  manifest::Camera c;
  c.model = "radial-tangential";
  c.width_px = 320;
  c.height_px = 240;
  c.fx_px = 266.4;
  c.fy_px = 266.95;
  c.cx_px = 171;
  c.cy_px = 116.7;
  c.distortion["k1"] = -0.280882;
  c.distortion["k2"] = 0.025178;
  c.distortion["p1"] = 0.001217;
  c.distortion["p2"] = -0.000136;
  c.distortion["k3"] = 0.163435;
  return c;
}

manifest::Camera pinhole(int width, int height) {
  manifest::Camera c;
  c.width_px = width;
  c.height_px = height;
  c.fx_px = c.fy_px = 300.0;
  c.cx_px = 0.47 * width;
  c.cy_px = 0.55 * height;
  return c;
}

io::Image photograph(const manifest::Camera& camera, const Scene& scene) {
  const CameraModel model(camera, "t");
  io::Image image(camera.width_px, camera.height_px, {"Y"});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec3 d = model.ray({x * 1.0, y * 1.0}).direction;
      image.at(x, y, 0) = static_cast<float>(scene(d.x / d.z, d.y / d.z));
    }
  return image;
}

Undistorted undistorted(const io::Image& source, const manifest::Camera& from, const manifest::Camera& to,
                        const Resampling& resampling = {}, const std::vector<std::uint8_t>& good = {}) {
  return undistort(source, good, CameraModel(from, "t"), CameraModel(to, "t"), resampling);
}

io::Image noise(int width, int height) {
  Random random(11);
  io::Image image(width, height, {"R", "G", "B"});
  for (float& v : image.data) v = static_cast<float>(std::exp(random.normal()));
  return image;
}

TEST(Undistort, ALensWithoutDistortionChangesNoBit) {
  const manifest::Camera camera = pinhole(83, 61);
  const io::Image source = noise(83, 61);
  for (const Kernel kernel : {Kernel::keys, Kernel::lanczos3}) {
    for (const Keep keep : {Keep::valid, Keep::all, Keep::same}) {
      const manifest::Camera to = pinhole_for(camera, {.keep = keep, .kernel = kernel}, "t");
      const Undistorted result = undistorted(source, camera, to, {.kernel = kernel});
      ASSERT_EQ(result.picture.data, source.data);
      EXPECT_EQ(std::ranges::count(result.valid, 1), 83 * 61);
    }
  }
}

TEST(Undistort, KernelsReproduceWhatTheyPromise) {
  const manifest::Camera camera = pinhole(60, 50);
  manifest::Camera shifted = camera;  // the same view between the pixels
  shifted.cx_px = camera.cx_px.scalar() + 0.37;
  shifted.cy_px = camera.cy_px.scalar() - 0.21;
  const std::vector<std::pair<Kernel, int>> exact = {{Kernel::keys, 2}, {Kernel::mitchell, 1}, {Kernel::lanczos3, 1}};
  for (const auto& [kernel, degree] : exact) {
    for (int a = 0; a <= degree; ++a)
      for (int b = 0; b <= degree; ++b) {
        const Scene scene = [&](double x, double y) { return std::pow(10 * x + 3, a) * std::pow(8 * y - 2, b); };
        const Undistorted result = undistorted(photograph(camera, scene), camera, shifted, {.kernel = kernel});
        const io::Image expected = photograph(shifted, scene);
        for (std::size_t i = 0; i < result.valid.size(); ++i) {
          if (!result.valid[i]) continue;
          ASSERT_NEAR(result.picture.data[i], expected.data[i], 2e-7 * (10 + std::abs(expected.data[i]))) << a << b;
        }
      }
  }
}

TEST(Undistort, WeightsOfABicubicSumToOne) {
  for (const Kernel kernel : {Kernel::keys, Kernel::mitchell})
    for (double t = 0; t < 1; t += 0.01) {
      double sum = 0;
      for (int i = -3; i <= 3; ++i) sum += kernel_weight(kernel, i - t);
      EXPECT_NEAR(sum, 1, 1e-14);
    }
  EXPECT_EQ(kernel_weight(Kernel::lanczos3, 0), 1);
  EXPECT_EQ(kernel_weight(Kernel::lanczos3, 2), 0);
  EXPECT_NEAR(kernel_weight(Kernel::lanczos3, 0.5), 0.6079271 * 1.0, 1e-6);  // sinc(1/2) sinc(1/6)
}

TEST(Undistort, ValidPicturesAreValidAndAsLargeAsCanBe) {
  for (const Kernel kernel : {Kernel::keys, Kernel::lanczos3}) {
    const manifest::Camera to = pinhole_for(barrel(), {.kernel = kernel}, "t");
    EXPECT_EQ(to.model, "pinhole");
    EXPECT_EQ(to.fx_px.scalar(), to.fy_px.scalar());
    const Undistorted result =
        undistorted(photograph(barrel(), [](double, double) { return 1.0; }), barrel(), to, {.kernel = kernel});
    EXPECT_EQ(std::ranges::count(result.valid, 0), 0);
    manifest::Camera larger = to;  // two more pixels on every side: some of them are not valid
    larger.width_px += 4;
    larger.height_px += 4;
    larger.cx_px = to.cx_px.scalar() + 2;
    larger.cy_px = to.cy_px.scalar() + 2;
    const CameraModel lens(barrel(), "t"), model(larger, "t");
    for (const int side : {0, 1, 2, 3}) {
      bool outside = false;
      for (int i = 0; i < (side < 2 ? larger.height_px : larger.width_px); ++i) {
        const Vec2 pixel = side == 0   ? Vec2{0, i * 1.0}
                           : side == 1 ? Vec2{larger.width_px - 1.0, i * 1.0}
                           : side == 2 ? Vec2{i * 1.0, 0}
                                       : Vec2{i * 1.0, larger.height_px - 1.0};
        const auto at = lens.project(model.ray(pixel).direction);
        const double margin = kernel_radius(kernel) - 1;
        outside = outside || !at || at->x < margin || at->y < margin || at->x > 319 - margin || at->y > 239 - margin;
      }
      EXPECT_TRUE(outside) << side;
    }
  }
}

TEST(Undistort, KeepAllShowsEverySourcePixel) {
  const manifest::Camera to = pinhole_for(barrel(), {.keep = Keep::all}, "t");
  const CameraModel lens(barrel(), "t"), model(to, "t");
  for (int i = 0; i < 320; i += 3)
    for (const int y : {0, 239}) {
      const auto at = model.project(lens.ray({i * 1.0, y * 1.0}).direction);
      ASSERT_TRUE(at);
      EXPECT_TRUE(at->x > -0.01 && at->y > -0.01 && at->x < to.width_px - 0.99 && at->y < to.height_px - 0.99);
    }
}

// Gaussian dots on a grid, photographed through the lens: their centroids lie where the pinhole sees the grid's points.
TEST(Undistort, PointsComeOutWithinAFiftiethOfAPixel) {
  for (const Kernel kernel : {Kernel::keys, Kernel::mitchell, Kernel::lanczos3}) {
    const manifest::Camera to = pinhole_for(barrel(), {.kernel = kernel}, "t");
    const double f = to.fx_px.scalar(), cx = to.cx_px.scalar(), cy = to.cy_px.scalar(), sigma = 2.5 / f;
    const double pitch = 26 / f;
    const Scene dots = [&](double x, double y) {
      const double dx = x - pitch * std::round(x / pitch), dy = y - pitch * std::round(y / pitch);
      return std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma));
    };
    const Undistorted result = undistorted(photograph(barrel(), dots), barrel(), to, {.kernel = kernel});
    double worst = 0;
    int seen = 0;
    for (int i = -7; i <= 7; ++i)
      for (int j = -5; j <= 5; ++j) {
        const Vec2 expected{f * pitch * i + cx, f * pitch * j + cy};
        const int left = static_cast<int>(std::lround(expected.x)) - 11,
                  top = static_cast<int>(std::lround(expected.y)) - 11;
        if (left < 0 || top < 0 || left + 23 > to.width_px || top + 23 > to.height_px) continue;
        double sum = 0, sx = 0, sy = 0;
        for (int y = top; y < top + 23; ++y)
          for (int x = left; x < left + 23; ++x) {
            const double v = result.picture.at(x, y, 0);
            sum += v;
            sx += v * x;
            sy += v * y;
          }
        worst = std::max(worst, norm(Vec2{sx / sum, sy / sum} - expected));
        ++seen;
      }
    EXPECT_GT(seen, 40);
    EXPECT_LT(worst, 0.02) << kernel_names[static_cast<std::size_t>(kernel)];
  }
}

TEST(Undistort, BentLinesBecomeStraight) {
  const manifest::Camera to = pinhole_for(barrel(), {}, "t");
  const double f = to.fx_px.scalar(), cx = to.cx_px.scalar(), cy = to.cy_px.scalar();
  for (const double slope : {0.03, -0.12}) {
    for (const double offset : {-0.3, 0.28}) {  // near the border, where the lens bends by 5 px
      const Scene line = [&](double x, double y) {
        const double d = (y - offset - slope * x) / std::hypot(1, slope) * f / 2;
        return std::exp(-0.5 * d * d);
      };
      const Undistorted result = undistorted(photograph(barrel(), line), barrel(), to);
      for (int x = 40; x < to.width_px - 40; x += 25) {
        const double expected = f * (offset + slope * (x - cx) / f) + cy;
        const int top = std::max(0, static_cast<int>(expected) - 10);
        double sum = 0, sy = 0;
        for (int y = top; y < std::min(to.height_px, top + 21); ++y) {
          sum += result.picture.at(x, y, 0);
          sy += result.picture.at(x, y, 0) * y;
        }
        if (expected < 11 || expected > to.height_px - 12) continue;
        EXPECT_NEAR(sy / sum, expected, 0.02);
      }
    }
  }
}

TEST(Undistort, AFisheyeBecomesAPinholeUpToTheAngleAskedFor) {
  manifest::Camera fisheye = barrel();
  fisheye.model = "fisheye";
  fisheye.distortion = {{"k1", -0.02}, {"k2", 0.01}};
  fisheye.fx_px = fisheye.fy_px = 110.0;  // beyond 90 degrees at the corners
  const manifest::Camera to = pinhole_for(fisheye, {.keep = Keep::all, .largest_angle_rad = 60 * pi / 180}, "t");
  const double half = std::max(to.cx_px.scalar(), to.width_px - to.cx_px.scalar());
  EXPECT_LT((half - 2) / to.fx_px.scalar(), std::tan(60 * pi / 180));
  const Scene wave = [](double x, double y) { return std::sin(3 * x) * std::cos(2 * y); };
  const Undistorted result = undistorted(photograph(fisheye, wave), fisheye, to);
  const io::Image expected = photograph(to, wave);
  for (std::size_t i = 0; i < result.valid.size(); ++i) {
    if (!result.valid[i]) continue;
    ASSERT_NEAR(result.picture.data[i], expected.data[i], 5e-3);
  }
}

TEST(Undistort, WhatASaturatedSampleTouchesIsNotValid) {
  const manifest::Camera camera = pinhole(40, 30);
  manifest::Camera shifted = camera;
  shifted.cx_px = camera.cx_px.scalar() + 0.5;
  std::vector<std::uint8_t> good(40 * 30, 1);
  good[15 * 40 + 20] = 0;
  const io::Image source = photograph(camera, [](double, double) { return 1.0; });
  for (const Kernel kernel : {Kernel::keys, Kernel::lanczos3}) {
    const int radius = static_cast<int>(kernel_radius(kernel));
    const Undistorted result = undistorted(source, camera, shifted, {.kernel = kernel}, good);
    for (int x = 10; x < 30; ++x) {
      const double at = x - 0.5;  // in the source
      EXPECT_EQ(result.valid[static_cast<std::size_t>(15 * 40 + x)] == 0, std::abs(at - 20) < radius) << x;
      EXPECT_EQ(result.valid[static_cast<std::size_t>(14 * 40 + x)], 1);  // whole rows are not mixed
    }
  }
  io::Image broken = source;
  broken.at(20, 15, 0) = std::nanf("");
  const Undistorted result = undistorted(broken, camera, shifted);
  EXPECT_EQ(result.valid[15 * 40 + 21], 0);
  EXPECT_EQ(result.valid[15 * 40 + 24], 1);
}

TEST(Undistort, OvershootIsKeptOrLimited) {
  const manifest::Camera camera = pinhole(60, 20);
  manifest::Camera shifted = camera;
  shifted.cx_px = camera.cx_px.scalar() + 0.3;
  const io::Image step = photograph(camera, [](double x, double) { return x > 0 ? 1.0 : 0.0; });
  for (const Kernel kernel : {Kernel::keys, Kernel::lanczos3}) {
    const auto kept = undistorted(step, camera, shifted, {.kernel = kernel}).picture.data;
    EXPECT_LT(*std::ranges::min_element(kept), -0.03);
    EXPECT_GT(*std::ranges::max_element(kept), 1.03);
    EXPECT_GT(*std::ranges::min_element(kept), -0.13);
    const auto limited = undistorted(step, camera, shifted, {.kernel = kernel, .limit_overshoot = true}).picture.data;
    EXPECT_EQ(*std::ranges::min_element(limited), 0);
    EXPECT_EQ(*std::ranges::max_element(limited), 1);
  }
}

// The variance that the channels state is the variance of what comes out.
TEST(Undistort, VarianceIsThatOfTheInterpolation) {
  const manifest::Camera camera = pinhole(200, 150);
  manifest::Camera shifted = camera;
  shifted.cx_px = camera.cx_px.scalar() + 0.4;
  shifted.cy_px = camera.cy_px.scalar() + 0.25;
  io::Image source(200, 150, {"Y", "variance.Y"});
  Random random(5);
  for (std::size_t i = 0; i < source.pixels(); ++i) {
    source.data[2 * i] = static_cast<float>(0.1 * random.normal());
    source.data[2 * i + 1] = 0.01f;
  }
  const Undistorted result = undistorted(source, camera, shifted);
  double squares = 0, stated = 0, n = 0;
  for (std::size_t i = 0; i < result.valid.size(); ++i) {
    if (!result.valid[i]) continue;
    squares += result.picture.data[2 * i] * result.picture.data[2 * i];
    stated += result.picture.data[2 * i + 1];
    n += 1;
  }
  EXPECT_NEAR(squares / stated, 1, 0.04);
  EXPECT_LT(stated / n, 0.01);
}

TEST(Undistort, HalfTheSizeHasNoMoire) {
  const manifest::Camera camera = pinhole(200, 160);
  const manifest::Camera half = pinhole_for(camera, {.scale = 0.5}, "t");
  EXPECT_NEAR(half.fx_px.scalar(), 150, 1e-9);
  io::Image stripes(200, 160, {"Y"});
  for (std::size_t i = 0; i < stripes.data.size(); ++i) stripes.data[i] = i % 2 == 0 ? 1.0f : 0.0f;
  const Undistorted result = undistorted(stripes, camera, half, {.stretch = 2});
  for (std::size_t i = 0; i < result.valid.size(); ++i) {
    if (!result.valid[i]) continue;
    ASSERT_NEAR(result.picture.data[i], 0.5, 0.02);
  }
}

TEST(Undistort, DoesNotDependOnThreads) {
  const io::Image source = noise(320, 240);
  const manifest::Camera to = pinhole_for(barrel(), {.keep = Keep::all}, "t");
  set_threads(1);
  const Undistorted one = undistorted(source, barrel(), to);
  set_threads(3);
  const Undistorted three = undistorted(source, barrel(), to);
  set_threads(0);
  EXPECT_EQ(one.picture.data, three.picture.data);
  EXPECT_EQ(one.valid, three.valid);
}

TEST(Undistort, RefusesPicturesBeyondReason) {
  EXPECT_THROW(pinhole_for(barrel(), {.keep = Keep::all, .scale = 200}, "t"), Error);
  manifest::Camera bad = barrel();
  bad.model = "orthographic";
  EXPECT_THROW(pinhole_for(bad, {}, "t"), Error);
}

}  // namespace
}  // namespace gonio::camera
