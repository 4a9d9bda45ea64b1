// Cameras: projection and ray undo each other, over random lenses and the whole picture; terms at zero change nothing;
// what cannot be a camera is refused in words.
#include "camera/camera_model.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/random.h"
#include "camera/board_projection.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"

namespace gonio::camera {
namespace {

manifest::Camera pinhole() {
  manifest::Camera c;
  c.model = "pinhole";
  c.width_px = 640;
  c.height_px = 480;
  c.fx_px = 532.8;
  c.fy_px = 533.9;
  c.cx_px = 342.5;
  c.cy_px = 233.9;
  return c;
}

manifest::Camera real_lens() {  // the left camera of the OpenCV stereo pair
  manifest::Camera c = pinhole();
  c.model = "radial-tangential";
  const std::array values{-0.280882, 0.025178, 0.001217, -0.000136, 0.163435};
  for (std::size_t i = 0; i < values.size(); ++i) c.distortion[std::string(distortion_names[i])] = values[i];
  return c;
}

manifest::Camera random_lens(Random& random) {
  manifest::Camera c = pinhole();
  c.model = "thin-prism";
  // Small enough that every lens reaches the corners of the picture (r = 0.8) before it folds back.
  const std::array sizes{0.08, 0.03, 0.003, 0.003, 0.02, 0.03, 0.01, 0.01, 0.003, 0.001, 0.003, 0.001};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    c.distortion[std::string(distortion_names[i])] = random.uniform(-sizes[i], sizes[i]);
  }
  return c;
}

double limit_of(double k1, double k2, double k3) {
  std::array<double, distortion_terms> c{};
  c[LensTerm::k1] = k1, c[LensTerm::k2] = k2, c[LensTerm::k3] = k3;
  return one_to_one_radius(c.data());
}

TEST(CameraModel, RayAndProjectionUndoEachOther) {
  Random random(1);
  for (int lens = 0; lens < 200; ++lens) {
    const CameraModel camera(random_lens(random), "t#/cameras/c");
    for (int i = 0; i < 50; ++i) {
      const Vec2 pixel{random.uniform(-0.5, 639.5), random.uniform(-0.5, 479.5)};
      const Ray ray = camera.ray(pixel);
      EXPECT_NEAR(norm(ray.direction), 1, 1e-14);
      const auto back = camera.project(ray.origin_m + ray.direction * random.uniform(0.1, 10));
      ASSERT_TRUE(back);
      EXPECT_LT(norm(*back - pixel), 1e-8) << pixel.x << " " << pixel.y;
    }
  }
}

TEST(CameraModel, RealLensIsInvertedOverTheWholePicture) {
  const CameraModel camera(real_lens(), "t#/cameras/c");
  for (int y = 0; y < 480; y += 7) {
    for (int x = 0; x < 640; x += 7) {
      const auto back = camera.project(camera.ray({x * 1.0, y * 1.0}).direction * 2.0);
      ASSERT_TRUE(back);
      EXPECT_LT(norm(*back - Vec2{x * 1.0, y * 1.0}), 1e-9);
    }
  }
}

TEST(CameraModel, KnownPixelOfTheDistortionEquations) {
  // x = 0.3, y = -0.2: r^2 = 0.13; R = 1 + 0.1 * 0.13 + 0.2 * 0.0169 + 0.3 * 0.002197
  manifest::Camera c = pinhole();
  c.model = "thin-prism";
  const std::array values{0.1, 0.2, 0.01, 0.02, 0.3, 0.0, 0.0, 0.0, 0.04, 0.05, 0.06, 0.07};
  for (std::size_t i = 0; i < values.size(); ++i) c.distortion[std::string(distortion_names[i])] = values[i];
  const double radial = 1 + 0.013 + 0.00338 + 0.0006591;
  const double x = 0.3 * radial + 2 * 0.01 * 0.3 * -0.2 + 0.02 * (0.13 + 0.18) + 0.04 * 0.13 + 0.05 * 0.0169;
  const double y = -0.2 * radial + 0.01 * (0.13 + 0.08) + 2 * 0.02 * 0.3 * -0.2 + 0.06 * 0.13 + 0.07 * 0.0169;
  const auto pixel = CameraModel(c, "t").project({0.6, -0.4, 2});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x, 532.8 * x + 342.5, 1e-10);
  EXPECT_NEAR(pixel->y, 533.9 * y + 233.9, 1e-10);
}

TEST(CameraModel, TermsAtZeroLeaveTheProjectionBitIdentical) {
  manifest::Camera with_terms = pinhole();
  with_terms.model = "fisheye";  // which has every term; fisheye = 0 is perspective
  for (const auto name : distortion_names) with_terms.distortion[std::string(name)] = 0.0;
  const CameraModel a(pinhole(), "a"), b(with_terms, "b");
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.5, 5)};
    EXPECT_EQ(a.project(p), b.project(p));
    const Intrinsics lens = intrinsics_of(with_terms, "b");
    Vec2 pixel;
    ASSERT_TRUE(predict(lens, {Quaternion{}, {0, 0, p.z}}, {}, {}, {p.x, p.y}, pixel));
    EXPECT_EQ(a.project({p.x, p.y, p.z}), pixel);
  }
}

TEST(CameraModel, NothingBehindTheCameraOrBeyondTheTurningPointOfTheLens) {
  const CameraModel camera(real_lens(), "t");
  EXPECT_FALSE(camera.project({0, 0, -1}));
  EXPECT_FALSE(camera.project({0, 0, 0}));
  manifest::Camera barrel = real_lens();
  barrel.distortion = {{"k1", -0.3}};
  const double limit = 1 / std::sqrt(0.9);  // 1 - 0.9 r^2 = 0
  EXPECT_NEAR(limit_of(-0.3, 0, 0), limit, 1e-12);
  const CameraModel folded(barrel, "t");
  EXPECT_TRUE(folded.project({limit - 1e-6, 0, 1}));
  EXPECT_FALSE(folded.project({limit + 1e-6, 0, 1}));
  EXPECT_TRUE(is_finite(folded.ray({1e5, 1e5}).direction));  // beyond what the lens can show
}

TEST(LensTerms, OneToOneRadiusIsWhereTheSlopeVanishesFirst) {
  EXPECT_EQ(limit_of(0, 0, 0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(limit_of(0.1, 0.2, 0), std::numeric_limits<double>::infinity());
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double k1 = random.uniform(-1, 1), k2 = random.uniform(-3, 3), k3 = random.uniform(-5, 5);
    const auto slope = [&](double u) { return 1 + u * (3 * k1 + u * (5 * k2 + u * 7 * k3)); };
    const double r = limit_of(k1, k2, k3);
    const double end = std::isfinite(r) ? r * r : 100;
    for (int j = 0; j < 200; ++j) ASSERT_GT(slope(end * (1 - 1e-9) * j / 200), 0);
    if (std::isfinite(r)) {
      EXPECT_NEAR(slope(r * r), 0, 1e-6);
    }
  }
}

TEST(CameraModel, OrthographicRaysAreParallel) {
  manifest::Camera c;
  c.model = "orthographic";
  c.width_px = 101;
  c.height_px = 51;
  c.px_per_m = 1000.0;
  const CameraModel camera(c, "t");
  EXPECT_TRUE(camera.orthographic());
  EXPECT_EQ(camera.principal_point_px(), (Vec2{50, 25}));
  const Ray ray = camera.ray({60, 20});
  EXPECT_EQ(ray.direction, (Vec3{0, 0, 1}));
  EXPECT_NEAR(ray.origin_m.x, 0.01, 1e-15);
  EXPECT_NEAR(ray.origin_m.y, -0.005, 1e-15);
  EXPECT_LT(norm(*camera.project(ray.origin_m + ray.direction * -3) - Vec2{60, 20}), 1e-12);
}

void expect_refused(const manifest::Camera& camera, const std::string& place) {
  try {
    CameraModel model(camera, "t#/cameras/c");
    FAIL() << "accepted; expected an error at " << place;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_EQ(e.place(), "t#/cameras/c" + place);
  }
}

TEST(CameraModel, ParallelIsTheOrthographicCameraOfAManifest) {
  manifest::Camera c;
  c.model = "orthographic";
  c.width_px = 30;
  c.height_px = 21;
  c.px_per_m = 100;
  const CameraModel stated(c, "t"), made = CameraModel::parallel(100, 30, 21);
  EXPECT_TRUE(made.orthographic());
  EXPECT_EQ(made.width_px(), 30);
  EXPECT_EQ(made.height_px(), 21);
  const Vec3 point{0.01, -0.02, 0.5};
  EXPECT_EQ(made.project(point)->x, stated.project(point)->x);
  EXPECT_EQ(made.project(point)->y, stated.project(point)->y);
  EXPECT_EQ(made.ray({3, 4}).origin_m, stated.ray({3, 4}).origin_m);
  EXPECT_EQ(made.ray({3, 4}).direction, stated.ray({3, 4}).direction);
}

TEST(CameraModel, RefusesWhatIsNoCamera) {
  manifest::Camera c = pinhole();
  c.fx_px = -5.0;
  expect_refused(c, "/fx_px");
  c = pinhole();
  c.model = "telecentric";
  expect_refused(c, "/model");
  c = pinhole();
  c.width_px = 0;
  expect_refused(c, "/width_px");
  c = pinhole();
  c.distortion["k1"] = 0.1;  // a pinhole has no lens
  expect_refused(c, "/distortion/k1");
  c = real_lens();
  c.distortion["k9"] = 0.1;
  expect_refused(c, "/distortion/k9");
  c = pinhole();
  c.cx_px = std::numeric_limits<double>::quiet_NaN();
  expect_refused(c, "/cx_px");
  c = pinhole();
  c.model = "orthographic";
  expect_refused(c, "/px_per_m");
}

TEST(Intrinsics, StoreAndReadGiveTheSameNumbers) {
  manifest::Camera c = real_lens();
  const Intrinsics before = intrinsics_of(c, "t");
  store(before, c);
  const Intrinsics after = intrinsics_of(c, "t");
  EXPECT_EQ(before.distortion, after.distortion);
  EXPECT_EQ(before.fx_px, after.fx_px);
  EXPECT_EQ(before.cy_px, after.cy_px);
}

TEST(Intrinsics, ADocumentsCameraIsAskedWithoutItsFields) {
  manifest::Document document;
  enter_pinhole(document, "c", 64, 41, 50);
  const manifest::Camera& entered = document.cameras.at("c");
  EXPECT_EQ(entered.model, "pinhole");
  const Intrinsics lens = intrinsics_of(entered, "t");
  EXPECT_EQ(lens.fx_px, 50);
  EXPECT_EQ(lens.fy_px, 50);
  EXPECT_EQ(lens.cx_px, 31.5);
  EXPECT_EQ(lens.cy_px, 20);
  EXPECT_EQ(picture_size_px(document, "c"), (std::array{64, 41}));
  EXPECT_EQ(picture_size_px(document, "d"), (std::array{0, 0}));
  EXPECT_EQ(mosaic_of(document, "c"), "");
  document.cameras["c"].mosaic = "RGGB";
  EXPECT_EQ(mosaic_of(document, "c"), "RGGB");
  EXPECT_EQ(mosaic_of(document, "d"), "");
}

}  // namespace
}  // namespace gonio::camera
