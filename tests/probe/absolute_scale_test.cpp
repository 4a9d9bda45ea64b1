// lib/probe/absolute_scale.h: what arrives at a tile, against integrals in closed form; the scale's error, against
// draws of what it says is uncertain; what is refused.
#include "probe/absolute_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "manifest/sections/flat_patch.h"
#include "probe/projection.h"

namespace gonio::probe {
namespace {

constexpr double level = 0.7;
const Vec3 slope{0.2, -0.3, 0.4};

// Radiance level + slope . d, twice as much in green; all of it seen.
Unwrapped surroundings(int columns) {
  const SphereMap map = sized(Projection::lat_long, columns / 2);
  Unwrapped u{io::Image(map.width, map.height, {"R", "G", "B"}), io::Image(map.width, map.height, {"Y", "footprint"}),
              0};
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const double value = level + dot(slope, direction_at(map, {x + 0.5, y + 0.5})->unit);
      for (int c = 0; c < 3; ++c) u.radiance.at(x, y, c) = static_cast<float>(value * (c == 1 ? 2 : 1));
      u.weight.at(x, y, 0) = 1;
    }
  return u;
}
// The integral over a half space: pi level + 2 pi / 3 slope . n.
double arriving(Vec3 n) {
  return pi * level + 2 * pi / 3 * dot(slope, n);
}

TEST(Arriving, IsTheIntegralOverTheHalfSpaceAndTheLamps) {
  const Unwrapped map = surroundings(256);
  for (const Vec3 n : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, normalized(Vec3{1, 2, -0.5}), normalized(Vec3{-1, 0.1, 0.2})}) {
    const Arriving a = arriving_at(map, {}, n);
    EXPECT_NEAR(a.irradiance.x, arriving(n), 4e-4);
    EXPECT_NEAR(a.irradiance.y, 2 * arriving(n), 8e-4);
    EXPECT_NEAR(a.sigma, 0, 1e-12);
    const Lamp before{n, {3, 3, 3}, {0.3, 0.3, 0.3}}, behind{-n, {9, 9, 9}, {}};
    const Arriving lit = arriving_at(map, {before, behind}, n);
    EXPECT_NEAR(lit.irradiance.x - a.irradiance.x, 3, 1e-9);
    EXPECT_NEAR(lit.sigma, 0.9 / (4 * arriving(n) + 9), 1e-4);
  }
}

// Half the upper sky not seen: it has half the light that arrives from above, and all of that is in doubt.
TEST(Arriving, WhatNobodySawIsInDoubt) {
  Unwrapped map = surroundings(256);
  for (float& v : map.radiance.data) v = 1;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) map.weight.at(x, y, 0) = 0;
  const Arriving a = arriving_at(map, {}, {0, 0, 1});
  EXPECT_NEAR(a.unseen, 0.5, 1e-6);
  EXPECT_NEAR(a.sigma, 0.5, 1e-6);
}

class OnATile : public testing::Test {
 protected:
  static constexpr int size = 60;
  OnATile() {
    // Half a metre above, looking down: the tile of 8 cm is 32 pixels wide.
    view_.world_from_camera = {quaternion_of(Mat3{{1, 0, 0, 0, -1, 0, 0, 0, -1}}), {0, 0, 0.5}};
    view_.picture = io::Image(size, size, {"R", "G", "B"});
    view_.place = "photo.exr";
  }
  static camera::CameraModel lens() {
    camera::Intrinsics i;
    i.fx_px = i.fy_px = 200, i.cx_px = i.cy_px = (size - 1) / 2.0;
    return {i, size, size};
  }
  static Tile tile(double reflectance, double relative_sigma) {
    manifest::FlatPatch entry;
    entry.polygon_m = {{-0.04, -0.04}, {0.04, -0.04}, {0.04, 0.04}, {-0.04, 0.04}};
    return {{entry, "tile"}, {}, {reflectance, reflectance, reflectance}, relative_sigma, "white"};
  }
  void paint(double factor, double noise, Random& random) {
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        for (int c = 0; c < 3; ++c)
          view_.picture.at(x, y, c) = static_cast<float>(0.9 / pi * arriving({0, 0, 1}) * (c == 1 ? 2 : 1) * factor *
                                                         (1 + noise * random.normal()));
  }
  void refused(const Unwrapped& map, const Tile& white, const std::string& part) const {
    try {
      scale_by_tile(map, {}, white, view_);
      ADD_FAILURE() << part;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::data);
      EXPECT_THAT(e.what(), testing::HasSubstr(part));
      EXPECT_THAT(e.what(), testing::StartsWith("photo.exr: "));
    }
  }
  ReferenceView view_{.picture = {}, .camera = lens(), .place = {}};
};

// 200 draws of noise, of the tile's reflectance and of a lamp, each with the deviation that is stated. The one
// per cent for unwrapping, which is no error here, takes the mean square of z to 0.66; it is outside of 0.45 to 1.1, or
// fewer than 180 are within 1.96, less than once in a thousand.
TEST_F(OnATile, TheScaleIsWithinItsError) {
  const Unwrapped map = surroundings(64);
  int covered = 0;
  double squares = 0;
  constexpr int draws = 200;
  for (int k = 0; k < draws; ++k) {
    Random random(static_cast<std::uint64_t>(k), 3);
    const double truth = 0.37, stated = 0.9 * (1 + 0.01 * random.normal()), lamp = 2 + 0.1 * random.normal();
    // Painted under the surroundings and a lamp of 2 from above.
    const double share = 1 + 2 * 3 / (4 * arriving({0, 0, 1}));
    paint(truth * share, 0.3, random);
    const Lamp found{{0, 0, 1}, {lamp, lamp, lamp}, {0.1, 0.1, 0.1}};
    const Scale scale = scale_by_tile(map, {found}, tile(stated, 0.01), view_);
    const double z = (scale.value - truth) / scale.sigma;
    covered += std::abs(z) < 1.96, squares += z * z / draws;
  }
  std::printf("scale: 95 %% interval covers %d of %d, mean square %.2f (1)\n", covered, draws, squares);
  EXPECT_GE(covered, 180);
  EXPECT_GT(squares, 0.45);
  EXPECT_LT(squares, 1.1);
}

TEST_F(OnATile, WhatSaysNothingIsRefused) {
  Random random(1, 1);
  paint(1, 0, random);
  const Unwrapped map = surroundings(64);
  EXPECT_NEAR(scale_by_tile(map, {}, tile(0.9, 0), view_).value, 1, 2e-3);
  Tile away = tile(0.9, 0);
  away.world_from_tile.translation_m = {5, 0, 0};
  refused(map, away, "is not to be seen");
  away = tile(0.9, 0);
  away.world_from_tile.rotation = {0, 1, 0, 0};  // shows its back
  refused(map, away, "is not to be seen");
  view_.clipped.assign(size * size, 0);
  view_.clipped[size * size / 2 + size / 2] = 1;
  refused(map, tile(0.9, 0), "is saturated in 1 of its");
  view_.clipped.clear();
  view_.counts.assign(size * size, 0);
  refused(map, tile(0.9, 0), "has 0 pixels that count");
  view_.counts.clear();
  Unwrapped night = map;
  for (float& v : night.radiance.data) v = 0;
  refused(night, tile(0.9, 0), "is lit by nothing");
  Unwrapped unseen = map;
  for (float& v : unseen.weight.data) v = 0;
  refused(unseen, tile(0.9, 0), "no photograph of the ball shows 100 %");
  for (float& v : view_.picture.data) v = 0;
  refused(map, tile(0.9, 0), "is dark");
}

}  // namespace
}  // namespace gonio::probe
