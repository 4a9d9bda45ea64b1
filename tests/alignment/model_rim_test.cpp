// Rims of meshes and of their shadows against filled triangles; slopes against differences; rims found in masks.
#include "alignment/model_rim.h"

#include <gtest/gtest.h>

#include <cmath>

#include "alignment/alignment_world.h"
#include "alignment/observed_rim.h"

namespace gonio::alignment {
namespace {

using testing::solids;
using testing::world_of;

TEST(ModelRim, BoundsWhatTheTrianglesFillForEveryGenus) {
  for (std::size_t k = 0; k < solids().size(); ++k) {
    const auto world = world_of({.solid = k, .seed = 40 + k, .size_px = 240});
    for (const bool shadow : {false, true}) {
      const RimSubject subject{0, 0, shadow ? std::optional<std::size_t>(0) : std::nullopt};
      const ModelRim rim(world.truth, subject);
      ASSERT_TRUE(rim.exists());
      const auto fine = testing::filled(world.truth, subject, 240, 240, 16);
      double inside = 0;
      bool cut = false;
      for (std::size_t i = 0; i < fine.size(); ++i) {
        inside += fine[i];
        const std::size_t x = i % 3840, y = i / 3840;
        cut = cut || (fine[i] && (x == 0 || y == 0 || x == 3839 || y == 3839));
      }
      if (cut) continue;
      // Samples miss by a share of one for every fine pixel along the rim.
      EXPECT_NEAR(moments_of(rim.pieces(), {0, 0}).m00, inside / 256, 0.02 * rim.length_px() / 16 + 0.5)
          << solids()[k].name << shadow;
    }
  }
}

TEST(ModelRim, SolidsHaveTheirGenus) {
  for (const auto& solid : solids()) {
    if (solid.name == "blob" || solid.name == "vase") continue;  // their poles are degenerate
    const auto e = static_cast<int>(solid.triangles.size()) * 3 / 2;
    const int euler = static_cast<int>(solid.positions_m.size()) - e + static_cast<int>(solid.triangles.size());
    EXPECT_EQ(euler, 2 - 2 * solid.genus) << solid.name;
    EXPECT_GT(Shape(solid.positions_m, solid.triangles).volume_m3(), 0) << solid.name;
  }
}

TEST(ModelRim, IsNoneBehindTheCameraOrAboveTheLamp) {
  auto world = world_of({.solid = 3, .size_px = 120});
  Setting s = world.truth;
  s.lamps_m[0] = s.bodies[0].centre_m();
  EXPECT_FALSE(ModelRim(s, {0, 0, 0}).exists());
  s.bodies[0].world_from_object.translation_m = s.stations[0].world_from_camera.translation_m;
  EXPECT_FALSE(ModelRim(s, {0, 0, {}}).exists());
}

TEST(Setting, SlopesOfAllNumbersAreThoseOfDifferences) {
  const auto world = world_of({.solid = 4, .seed = 3, .scale_sigma = 0.05, .size_px = 120});
  Setting s = world.truth;
  s.ground->normal = normalized(Vec3{0.05, -0.08, 1});
  const std::vector<Freedom> freedoms{{Block::body_turn, 0},    {Block::body_shift, 0},    {Block::body_scale, 0},
                                      {Block::station_turn, 0}, {Block::station_shift, 0}, {Block::lens_focal, 0},
                                      {Block::lamp_shift, 0},   {Block::ground_tilt, 0},   {Block::ground_shift, 0}};
  const std::size_t count = numbers_of(freedoms);
  ASSERT_EQ(count, 22u);
  const GroundAxes axes = ground_axes(s);
  const Vec3 point = s.bodies[0].shape->positions_m()[77];
  const Vec2 normal{0.6, -0.8};
  for (const bool shadow : {false, true}) {
    const std::optional<std::size_t> lamp = shadow ? std::optional<std::size_t>(0) : std::nullopt;
    std::vector<double> row(count), height(count);
    slopes_of(s, freedoms, axes, 0, 0, lamp, point, normal, row.data());
    height_slopes(s, freedoms, axes, 0, point, height.data());
    for (std::size_t k = 0; k < count; ++k) {
      std::array<double, 2> at{}, high{};
      for (const int e : {0, 1}) {
        std::vector<double> change(count, 0);
        change[k] = e ? 1e-6 : -1e-6;
        const Setting m = moved(s, freedoms, change);
        const Vec3 world_point = m.bodies[0].place_m(point);
        at[e] = dot(normal, (shadow ? project_shadow(m, 0, 0, world_point) : project(m, 0, world_point)).pixel);
        high[e] = height_of(m, 0, point);
      }
      EXPECT_NEAR(row[k], (at[1] - at[0]) / 2e-6, 1e-5 * (1 + std::abs(row[k]))) << k << " " << shadow;
      EXPECT_NEAR(height[k], (high[1] - high[0]) / 2e-6, 1e-8) << k;
    }
  }
}

TEST(Setting, ChangeBetweenUndoesMoved) {
  const auto world = world_of({.solid = 5, .size_px = 120});
  const std::vector<Freedom> freedoms{{Block::body_turn, 0},    {Block::body_shift, 0}, {Block::body_scale, 0, 0, true},
                                      {Block::station_turn, 0}, {Block::lamp_shift, 0}, {Block::lens_focal, 0}};
  std::vector<double> change(numbers_of(freedoms));
  for (std::size_t k = 0; k < change.size(); ++k) change[k] = 1e-3 * (1.0 + static_cast<double>(k));
  const auto back = change_between(world.truth, moved(world.truth, freedoms, change), freedoms);
  for (std::size_t k = 0; k < change.size(); ++k) EXPECT_NEAR(back[k], change[k], 1e-9);
}

// A disc's rim: the mean offset outwards and the scatter.
std::pair<double, double> disc_error(bool binary, double radius, double smooth) {
  Region r{100, 100, std::vector<float>(10000), {}, 0};
  const Vec2 c{49.3, 51.7};
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      int inside = 0;
      for (int k = 0; k < 256; ++k)
        inside += std::hypot(x + (k % 16 - 7.5) / 16 - c.x, y + (k / 16 - 7.5) / 16 - c.y) < radius;
      r.share[static_cast<std::size_t>(y) * 100 + x] = binary ? inside >= 128 : static_cast<float>(inside) / 256;
    }
  double sum = 0, squares = 0;
  const auto points = rim_points(r, smooth, 10);
  EXPECT_NEAR(static_cast<double>(points.size()), 2 * pi * radius, 4);
  for (const RimPoint& p : points) {
    const Vec2 d = p.pixel - c;
    EXPECT_GT(dot(d, p.outward), 0.9 * norm(d));
    sum += norm(d) - radius, squares += (norm(d) - radius) * (norm(d) - radius);
  }
  const auto n = static_cast<double>(points.size());
  return {sum / n, std::sqrt(squares / n)};
}

TEST(ObservedRim, OfADiscIsWhereItIs) {
  for (const double radius : {10.0, 20.0, 35.0}) {
    const auto [mean, rms] = disc_error(false, radius, 0.6);
    EXPECT_NEAR(mean, 0, 0.01) << radius;
    EXPECT_LT(rms, 0.03) << radius;
    const auto [coarse_mean, coarse_rms] = disc_error(true, radius, 1.2);
    EXPECT_NEAR(coarse_mean, 0, 0.04) << radius;
    EXPECT_LT(coarse_rms, 0.2) << radius;
  }
}

TEST(ObservedRim, HolesRunTheOtherWayAndBordersDoNotCount) {
  Region r{60, 60, std::vector<float>(3600, 0), {}, 0};
  for (int y = 10; y < 50; ++y)
    for (int x = 0; x < 40; ++x)
      r.share[static_cast<std::size_t>(y) * 60 + x] = x > 15 && x < 30 && y > 20 && y < 40 ? 0 : 1;
  const auto points = rim_points(r, 0.8, 10);
  std::size_t of_hole = 0, not_counted = 0;
  for (const RimPoint& p : points) {
    if (!p.counts) ++not_counted;
    if (p.pixel.x > 12 && p.pixel.x < 33 && p.pixel.y > 17 && p.pixel.y < 43) {
      ++of_hole;
      EXPECT_GT(dot(p.outward, Vec2{22.5, 30} - p.pixel), 0);
    }
  }
  EXPECT_NEAR(static_cast<double>(of_hole), 66, 6);
  EXPECT_GT(not_counted, 1u);
}

}  // namespace
}  // namespace gonio::alignment
