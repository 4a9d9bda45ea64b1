// The lens map against OpenCV's two projections, its derivatives against central differences and dual numbers, and the
// ways in which its terms vanish.
#include "camera/lens_terms.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "base/random.h"
#include "camera/camera_model.h"
#include "manifest/sections/camera.h"

namespace gonio::camera {
namespace {

using Terms = std::array<double, distortion_terms>;

Vec3 direction(Random& random, double widest) {
  const double theta = random.uniform(0, widest), azimuth = random.uniform(-pi, pi), size = random.uniform(0.3, 3);
  return Vec3{std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), std::cos(theta)} * size;
}

Terms random_terms(Random& random, double fisheye, double size) {
  Terms c{};
  for (double& v : c) v = random.uniform(-size, size);
  c[LensTerm::fisheye] = fisheye;
  return c;
}

manifest::Camera camera_of(const std::string& model, const Terms& terms) {
  manifest::Camera c;
  c.model = model;
  c.width_px = 1000, c.height_px = 800;
  c.fx_px = 400.0, c.fy_px = 410.0, c.cx_px = 490.0, c.cy_px = 405.0;
  const CameraModelInfo& info = camera_model_info(model, "t");
  for (std::size_t i = 0; i < distortion_terms; ++i) {
    if (info.fitted.has(i)) c.distortion[std::string(distortion_names[i])] = terms[i];
  }
  return c;
}

const cv::Matx33d matrix{400, 0, 490, 0, 410, 405, 0, 0, 1};

TEST(LensTerms, PerspectiveModelsProjectAsOpenCv) {
  Random random(21);
  for (const char* model : {"pinhole", "radial-tangential", "rational", "thin-prism"}) {
    for (int i = 0; i < 300; ++i) {
      const Terms c = random_terms(random, 0, 0.05);
      const CameraModel camera(camera_of(model, c), "t");
      std::vector<double> peer(c.begin(), c.begin() + 12);
      const CameraModelInfo& info = camera_model_info(model, "t");
      for (std::size_t k = 0; k < peer.size(); ++k) peer[k] *= info.fitted.has(k);
      const Vec3 p = direction(random, 0.7);
      std::vector<cv::Point2d> seen;
      cv::projectPoints(std::vector{cv::Point3d(p.x, p.y, p.z)}, cv::Vec3d(), cv::Vec3d(), matrix, peer, seen);
      const auto pixel = camera.project(p);
      ASSERT_TRUE(pixel) << model;
      EXPECT_NEAR(pixel->x, seen[0].x, 1e-9) << model;
      EXPECT_NEAR(pixel->y, seen[0].y, 1e-9) << model;
    }
  }
}

TEST(LensTerms, TheFisheyeProjectsAsOpenCvAndSeesBeyondNinetyDegrees) {
  Random random(22);
  for (int i = 0; i < 1000; ++i) {
    const Terms c = random_terms(random, 1, 0.001);
    const CameraModel camera(camera_of("fisheye", c), "t");
    const Vec3 p = direction(random, 1.5);
    std::vector<cv::Point2d> seen;
    cv::fisheye::projectPoints(std::vector{cv::Point3d(p.x, p.y, p.z)}, seen, cv::Affine3d::Identity(), matrix,
                               cv::Vec4d(c[0], c[1], c[4], c[5]));
    const auto pixel = camera.project(p);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, seen[0].x, 1e-9);
    EXPECT_NEAR(pixel->y, seen[0].y, 1e-9);
  }
  // 100 degrees from the axis, where the formula says theta (1 + k1 theta^2) f.
  Terms c{};
  c[LensTerm::k1] = 0.01, c[LensTerm::fisheye] = 1;
  const CameraModel camera(camera_of("fisheye", c), "t");
  const double theta = 100 * pi / 180;
  const auto pixel = camera.project({std::sin(theta), 0, std::cos(theta)});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x, 400 * theta * (1 + 0.01 * theta * theta) + 490, 1e-9);
  const Ray back = camera.ray(*pixel);
  EXPECT_NEAR(back.direction.z, std::cos(theta), 1e-12);
  EXPECT_FALSE(camera.project({0, 0, -1}));  // straight behind: everywhere on a circle
}

TEST(LensTerms, RaysUndoTheFisheyeOverItsWholeField) {
  Random random(23);
  for (int i = 0; i < 500; ++i) {
    Terms c = random_terms(random, i % 2 == 0 ? 1.0 : random.uniform(0, 1), 0.002);
    manifest::Camera section = camera_of("fisheye", c);
    section.distortion["fisheye"] = c[LensTerm::fisheye];
    const CameraModel camera(section, "t");
    const double widest = std::min(1.6 * 1.57, 0.9 * 1.57 / std::max(1e-9, 1 - c[LensTerm::fisheye]));
    const Vec3 d = normalized(direction(random, widest));
    const auto pixel = camera.project(d);
    if (!pixel) continue;  // beyond the turning point of a strong polynomial
    EXPECT_LT(norm(camera.ray(*pixel).direction - d), 1e-8);
  }
}

TEST(LensTerms, TheFamilyPassesFromTangentToAngle) {
  for (const double theta : {0.001, 0.003, 0.01, 0.5, 1.2}) {
    const std::array p{std::sin(theta), 0.0, std::cos(theta)};
    for (const double fisheye : {0.0, 1e-9, 0.3, 0.999999, 1.0}) {
      double x = 0, y = 0;
      ASSERT_TRUE(lay_on_plane(fisheye, p.data(), &x, &y));
      const long double l = 1 - static_cast<long double>(fisheye);
      const long double exact = fisheye == 1 ? theta : std::tan(l * theta) / l;
      EXPECT_NEAR(x, static_cast<double>(exact), 1e-13) << theta << " " << fisheye;
      EXPECT_EQ(y, 0);
      EXPECT_NEAR(angle_of_radius(fisheye, x), theta, 1e-13 * (1 + x * x));
    }
  }
}

// Both the closed form and the template under dual numbers, over all of the family and at its ends.
TEST(LensTerms, DerivativesAgreeWithDifferencesAndDualNumbers) {
  using Jet = ceres::Jet<double, 3 + static_cast<int>(distortion_terms)>;
  Random random(24);
  for (int i = 0; i < 2000; ++i) {
    const double fisheye = i % 4 == 0 ? 0 : i % 4 == 1 ? 1 : random.uniform(0.01, 0.99);
    const Terms c = random_terms(random, fisheye, 0.03);
    const Vec3 p = direction(random, i % 8 < 4 ? 0.9 : 0.02);
    LensMap map;
    ASSERT_TRUE(lens_map_derivatives(c.data(), p, map));
    const auto value = [](const Terms& terms, Vec3 at) {
      const std::array d{at.x, at.y, at.z};
      double x = 0, y = 0;
      Vec2 result;
      EXPECT_TRUE(lay_on_plane(terms[LensTerm::fisheye], d.data(), &x, &y));
      distort(terms.data(), x, y, &result.x, &result.y);
      return result;
    };
    EXPECT_LT(norm(Vec2{map.x, map.y} - value(c, p)), 1e-13);
    std::array<Jet, 3> d{Jet(p.x, 0), Jet(p.y, 1), Jet(p.z, 2)};
    std::array<Jet, distortion_terms> terms;
    for (std::size_t k = 0; k < distortion_terms; ++k) terms[k] = Jet(c[k], static_cast<int>(3 + k));
    Jet x, y, u, v;
    ASSERT_TRUE(lay_on_plane(terms[LensTerm::fisheye], d.data(), &x, &y));
    distort(terms.data(), x, y, &u, &v);
    for (int k = 0; k < 3 + static_cast<int>(distortion_terms); ++k) {
      const auto at = static_cast<std::size_t>(k);
      const Vec2 exact{k < 3 ? map.by_direction[0][at] : map.by_term[0][at - 3],
                       k < 3 ? map.by_direction[1][at] : map.by_term[1][at - 3]};
      EXPECT_LT(norm(exact - Vec2{u.v[k], v.v[k]}), 1e-9 * (1 + norm(exact))) << k << " fisheye " << fisheye;
      Terms ca = c, cb = c;
      Vec3 a = p, b = p;
      const double step = 1e-5;
      if (k < 3) {
        (k == 0 ? a.x : k == 1 ? a.y : a.z) += step;
        (k == 0 ? b.x : k == 1 ? b.y : b.z) -= step;
      } else {
        ca[at - 3] += step;
        cb[at - 3] -= step;
      }
      EXPECT_LT(norm(exact - (value(ca, a) - value(cb, b)) * (0.5 / step)), 1e-6 * (1 + norm(exact))) << k;
    }
  }
}

TEST(LensTerms, OneToOneLimitOfDenominatorsAndOfTheFisheye) {
  Terms c{};
  c[LensTerm::k4] = -0.25;  // a pole at r = 2
  EXPECT_NEAR(one_to_one_radius(c.data()), 2, 1e-12);
  c[LensTerm::k4] = 1;  // r / (1 + r^2) turns at r = 1
  EXPECT_NEAR(one_to_one_radius(c.data()), 1, 1e-12);
  c = {};
  c[LensTerm::fisheye] = 1;
  EXPECT_EQ(one_to_one_radius(c.data()), pi);
  c[LensTerm::k1] = -0.1;  // 1 - 0.3 theta^2
  EXPECT_NEAR(one_to_one_radius(c.data()), 1 / std::sqrt(0.3), 1e-12);
}

TEST(Intrinsics, ModelsGrowByTheTermsTheyNeed) {
  EXPECT_EQ(model_with("pinhole", {LensTerm::k1}), "radial-tangential");
  EXPECT_EQ(model_with("radial-tangential", {LensTerm::p1}), "radial-tangential");
  EXPECT_EQ(model_with("radial-tangential", {LensTerm::k4}), "rational");
  EXPECT_EQ(model_with("radial-tangential", {LensTerm::s1}), "thin-prism");
  EXPECT_EQ(model_with("rational", {LensTerm::s1}), "thin-prism");
  EXPECT_EQ(model_with("thin-prism", {LensTerm::fisheye}), "fisheye");
  EXPECT_EQ(model_with("fisheye", {LensTerm::p1}), "fisheye");
}

TEST(Intrinsics, AFisheyeNeedsNotSayThatItIsOne) {
  manifest::Camera c = camera_of("fisheye", {});
  EXPECT_EQ(intrinsics_of(c, "t").distortion[LensTerm::fisheye], 1);
  Intrinsics lens = intrinsics_of(c, "t");
  store(lens, c);
  EXPECT_FALSE(c.distortion.contains("fisheye"));
  lens.distortion[LensTerm::fisheye] = 0.25;
  store(lens, c);
  EXPECT_EQ(intrinsics_of(c, "t").distortion[LensTerm::fisheye], 0.25);
}

}  // namespace
}  // namespace gonio::camera
