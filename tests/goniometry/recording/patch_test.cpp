// Pixels on a patch cover it but for its edge, whatever the lens does; parts of a patch that leave the others' course.
#include "goniometry/sample/patch.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "goniometry/sample/patch_cells.h"
#include "manifest/sections/flat_patch.h"
#include "recordings.h"

namespace gonio::goniometry {
namespace {

using tests::direction;

manifest::FlatPatch disc(double radius_m) {
  manifest::FlatPatch entry;
  entry.radius_m = radius_m;
  return entry;
}
manifest::FlatPatch polygon(std::vector<std::vector<double>> corners_m) {
  manifest::FlatPatch entry;
  entry.polygon_m = std::move(corners_m);
  return entry;
}

Rigid<frame::Camera, frame::Object> seen_from(double theta_rad, double phi_rad, double distance_m) {
  const auto world_from_camera = render::looking_at(direction(theta_rad, phi_rad) * distance_m, {});
  const auto back = inverse(world_from_camera);
  return {back.rotation, back.translation_m};
}

camera::CameraModel distorted(double k1, double fisheye = 0) {
  camera::Intrinsics lens{700, 690, 165, 117, {}};
  lens.distortion[camera::LensTerm::k1] = k1;
  lens.distortion[camera::LensTerm::fisheye] = fisheye;
  return {lens, 320, 240};
}

double area_of(const Footprint& print) {
  double sum = 0;
  for (const PatchPixel& pixel : print.pixels) sum += pixel.area_m2;
  return sum;
}

// Of N pixels about 2 sqrt(pi N) lie on the edge, half of whose area is inside.
TEST(Footprint, CoversThePatchButForItsEdge) {
  const Patch patch(disc(0.04), "p");
  for (const auto& camera : {distorted(-0.25), distorted(0.2), distorted(0.02, 1)})
    for (const double theta : {2 * degree, 45 * degree, 75 * degree}) {
      const Footprint print = footprint(patch, camera, seen_from(theta, 0.7, 0.45));
      ASSERT_TRUE(print.refusal.empty()) << print.refusal;
      const double all = pi * 0.04 * 0.04, count = print.pixels.size();
      EXPECT_LT(area_of(print), all);
      EXPECT_NEAR(area_of(print) / all, 1, 3 * std::sqrt(pi / (count * std::cos(theta))));
      Vec2 middle;
      for (const PatchPixel& pixel : print.pixels) middle = middle + pixel.at * (pixel.area_m2 / area_of(print));
      EXPECT_LT(norm(middle), 0.001);
    }
}

TEST(Footprint, PixelsLieWhereTheLensPutsThem) {
  const Patch patch(polygon({{-0.02, -0.03}, {0.03, -0.02}, {0.02, 0.03}, {-0.01, 0.01}}), "p");
  const auto camera = distorted(-0.25);
  const auto pose = seen_from(40 * degree, 2.1, 0.4);
  const Footprint print = footprint(patch, camera, pose);
  ASSERT_GT(print.pixels.size(), 500u);
  for (const PatchPixel& pixel : print.pixels) {
    const auto back = camera.project(pose * Vec3{pixel.at.x, pixel.at.y, 0});
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->x, pixel.x, 0.02);
    EXPECT_NEAR(back->y, pixel.y, 0.02);
    EXPECT_TRUE(patch.holds(pixel.at));
  }
}

TEST(Footprint, APartOutsideThePictureIsSaid) {
  const auto camera = distorted(-0.25);
  const Footprint print = footprint(Patch(disc(0.2), "p"), camera, seen_from(0.3, 0, 0.45));
  EXPECT_NE(print.refusal.find("outside the picture"), std::string::npos);
}

TEST(Patch, CentroidAndRefusals) {
  const Patch corner(polygon({{1, 1}, {4, 1}, {1, 4}}), "p");
  EXPECT_NEAR(corner.middle().x, 2, 1e-12);
  EXPECT_NEAR(corner.middle().y, 2, 1e-12);
  for (const auto& bad : {polygon({{0, 0}, {1, 0}}), polygon({{0, 0}, {1, 0}, {2, 0}}),
                          polygon({{0, 0, 1}, {1, 0}, {1, 1}}), polygon({{0, 0}, {1, 0}, {1, std::nan("")}})})
    EXPECT_THROW(Patch(bad, "p"), Error);
}

// A smooth course with noise of a twentieth, 64 cells.
std::vector<PatchCell> cells(std::uint64_t seed, double noise, double step = 0) {
  Random random(seed);
  std::vector<PatchCell> result;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const Vec2 at{(x - 3.5) / 4, (y - 3.5) / 4};
      double v = 1 + 0.4 * at.x - 0.2 * at.y + 0.3 * at.x * at.x;
      if (x < 2) v *= 1 - step;
      const auto noisy = [&] { return v + noise * random.normal(); };
      const Rgb variance = Rgb{1, 1, 1} * (noise * noise);
      const Rgb ratio{noisy(), noisy(), noisy()};
      result.push_back({at, ratio, variance, Rgb{1, 1, 1} / 64.0, mean(ratio)});
    }
  return result;
}

// Three bands of 58 degrees of freedom in 300 patches: the mean of the variance is known to sqrt(2 / 52200) = 0.6 %,
// limit 4.5 of them.
TEST(PatchCells, ScatterHasTheNoisesVariance) {
  double sum = 0;
  for (int i = 0; i < 300; ++i) sum += mean(scatter_of(cells(i, 0.05)).variance) / 300;
  EXPECT_NEAR(sum / (0.05 * 0.05 / 64), 1, 0.028);
}

// Six standard deviations in one of 64 cells, three bands' mean: none in 2000 patches but for 1e-4.
TEST(PatchCells, NoiseAndCoursesAreNotTakenForThingsInFront) {
  int alarms = 0;
  for (int i = 0; i < 2000; ++i) alarms += outlying_cells(cells(1000 + i, 0.05)).count > 0;
  EXPECT_EQ(alarms, 0);
}

TEST(PatchCells, AThingOverAQuarterIsSeen) {
  int seen = 0;
  for (int i = 0; i < 100; ++i) seen += outlying_cells(cells(5000 + i, 0.02, 0.5)).count >= 12;
  EXPECT_EQ(seen, 100);
}

}  // namespace
}  // namespace gonio::goniometry
