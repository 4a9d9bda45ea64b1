// Whole alignments of simulated photographs: from near, from nothing, symmetric, mirrored, lost; how honest the
// intervals are.
#include <gtest/gtest.h>

#include <cmath>

#include "alignment/align_bodies.h"
#include "alignment/alignment_world.h"

namespace gonio::alignment {
namespace {

using testing::miss_of;
using testing::solids;
using testing::world_of;

// 24 scenes of 9 to 12 numbers: with errors that are alike within a scene, some 100 independent ones. At 95 % coverage
// fewer than 86 % of them inside happen once in some thousand runs.
TEST(Align, FromNearItConvergesAndItsIntervalsHold) {
  double inside = 0, all = 0, squares = 0;
  for (std::size_t k = 0; k < 24; ++k) {
    const std::size_t solid = std::array<std::size_t, 6>{0, 3, 4, 5, 6, 7}[k % 6];
    auto world = world_of({.solid = solid,
                           .views = 1 + static_cast<int>(k / 12),
                           .seed = 100 + k,
                           .scale_sigma = k >= 12 && k % 2 ? 0.03 : 0.0});
    const Aligned found = align_bodies(world.input, {.from = AlignWish::From::stated}).front();
    EXPECT_EQ(found.verdict, Verdict::found) << solids()[solid].name << " " << k << " " << found.why;
    const auto miss = miss_of(world, found.fitted);
    EXPECT_LT(miss.turn_rad, 0.03) << k;
    EXPECT_LT(miss.shift_m, 0.003) << k;
    for (std::size_t i = 0; i < miss.error.size(); ++i) {
      const double z = miss.error[i] / miss.sigma[i];
      inside += std::abs(z) < 1.96, all += 1, squares += z * z;
    }
  }
  EXPECT_GT(inside / all, 0.86);
  EXPECT_LT(std::sqrt(squares / all), 1.4);
  RecordProperty("coverage", std::to_string(inside / all));
}

TEST(Align, FromNothing) {
  for (std::size_t k = 0; k < 6; ++k) {
    auto world =
        world_of({.solid = std::array<std::size_t, 6>{0, 3, 4, 5, 6, 7}[k], .seed = 300 + k, .from_nothing = true});
    const Aligned found = align_bodies(world.input, {.from = AlignWish::From::nothing}).front();
    EXPECT_EQ(found.verdict, Verdict::found) << k << " " << found.why;
    EXPECT_LT(miss_of(world, found.fitted).turn_rad, 0.03) << k;
  }
}

TEST(Align, WhatLooksAlikeIsSaid) {
  auto vase = world_of({.solid = 1, .seed = 5});
  const Aligned turned = align_bodies(vase.input, {.from = AlignWish::From::stated}).front();
  EXPECT_EQ(turned.verdict, Verdict::ambiguous);
  ASSERT_FALSE(turned.symmetries.empty());
  EXPECT_NE(turned.symmetries[0].find("(0.00, 0.00, 1.00) of the mesh by any angle"), std::string::npos)
      << turned.symmetries[0];
  auto brick = world_of({.solid = 2, .views = 2, .seed = 6});
  const Aligned boxed = align_bodies(brick.input, {.from = AlignWish::From::stated}).front();
  EXPECT_EQ(boxed.verdict, Verdict::ambiguous);
  EXPECT_EQ(boxed.symmetries.size(), 3u);  // half turns about its three axes
}

TEST(Align, AMirroredMeshIsNamed) {
  auto world = world_of({.solid = 4, .views = 2, .seed = 9});
  const Shape& shape = world.input.shapes.front();
  std::vector<Vec3> positions = shape.positions_m();
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (Vec3& p : positions) p.y = -p.y;
  for (std::size_t t = 0; t < shape.triangles(); ++t)
    triangles.push_back({shape.triangle(t)[0], shape.triangle(t)[2], shape.triangle(t)[1]});
  world.input.shapes.emplace_back(positions, triangles);
  world.input.stated.bodies[0].shape = world.input.question.stated.bodies[0].shape = &world.input.shapes.back();
  const Aligned found = align_bodies(world.input, {}).front();
  EXPECT_EQ(found.verdict, Verdict::mirrored) << found.why;
}

TEST(Align, AnotherMeshIsLost) {
  auto world = world_of({.solid = 3, .views = 2, .seed = 11});
  const auto& other = solids()[7];
  world.input.shapes.emplace_back(other.positions_m, other.triangles);
  world.input.stated.bodies[0].shape = world.input.question.stated.bodies[0].shape = &world.input.shapes.back();
  const Aligned found = align_bodies(world.input, {}).front();
  EXPECT_EQ(found.verdict, Verdict::lost);
  EXPECT_FALSE(found.why.empty());
}

TEST(Align, AMaskUnderSeveralLampsCountsOnce) {
  auto world = world_of({.solid = 5, .seed = 21});
  const Aligned once = align_bodies(world.input, {.from = AlignWish::From::stated}).front();
  for (int k = 0; k < 3; ++k)
    world.input.question.sightings.push_back(world.input.question.sightings[0]),
        world.input.rims.push_back(world.input.rims[0]);
  const Aligned four = align_bodies(world.input, {.from = AlignWish::From::stated}).front();
  for (Eigen::Index i = 0; i < 6; ++i)
    EXPECT_NEAR(std::sqrt(four.fitted.covariance(i, i) / once.fitted.covariance(i, i)), 1, 0.25) << i;
}

}  // namespace
}  // namespace gonio::alignment
