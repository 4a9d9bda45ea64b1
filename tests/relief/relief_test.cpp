// Reliefs: rays against a slow march, tiling, gaps, and the profiles that ridges and sinusoids are made from.
#include "relief/relief.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "relief/lobe.h"
#include "relief/ridges.h"

namespace gonio::relief {
namespace {

Relief random_relief(int nx, int ny, double step_x, double step_y, double amplitude, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> z;
  for (int i = 0; i < nx * ny; ++i) z.push_back(amplitude * random.uniform(-1, 1));
  return {nx, ny, step_x, step_y, std::move(z), true};
}

double height_at(const Relief& r, double x, double y) {
  const auto wrap = [](double a, int n) { return a - n * std::floor(a / n); };
  const double gx = wrap(x / r.step_x_m(), r.nx()), gy = wrap(y / r.step_y_m(), r.ny());
  const int i = std::min(static_cast<int>(gx), r.nx() - 1), j = std::min(static_cast<int>(gy), r.ny() - 1);
  return r.height_m({i, j, gx - i, gy - j});
}

// In steps of a 400th of a cell.
std::optional<Vec3> marched(const Relief& r, Vec3 from, Vec3 w, double lift) {
  const double step = std::min(r.step_x_m(), r.step_y_m()) / 400;
  for (double t = lift; t < 1e6 * step; t += step) {
    const Vec3 p = from + w * t;
    if (p.z > r.highest_m() && w.z >= 0) return {};
    if (p.z < height_at(r, p.x, p.y)) return p;
  }
  return {};
}

TEST(Relief, RaysMeetWhatASlowMarchMeets) {
  const Relief r = random_relief(13, 9, 1e-6, 1.5e-6, 1e-6, 5);
  Random random(8);
  int met = 0, escaped = 0;
  for (int k = 0; k < 150; ++k) {
    const double x = random.uniform() * r.width_m(), y = random.uniform() * r.length_m();
    const Vec3 down = -direction_of(random.uniform(0, 1.5), random.uniform(0, 2 * pi));
    const auto hit = r.met_from_above(x, y, down);
    ASSERT_TRUE(hit) << k;
    const auto slow = marched(r, {x, y, r.highest_m()}, down, 0);
    ASSERT_TRUE(slow);
    EXPECT_NEAR(hit->z_m, slow->z, 0.03e-6) << k;
    EXPECT_GT(hit->normal.z, 0);
    EXPECT_LT(dot(hit->normal, down), 0);
    // onwards
    const Basis frame(hit->normal);
    const Vec3 on = frame.to_world(direction_of(random.uniform(0, 1.4), random.uniform(0, 2 * pi)));
    const auto next = r.met_from(*hit, on);
    const Vec3 at{(hit->place.i + hit->place.u) * r.step_x_m(), (hit->place.j + hit->place.v) * r.step_y_m(), hit->z_m};
    const auto slow_next = marched(r, at, on, 2e-9);
    EXPECT_EQ(next.has_value(), slow_next.has_value()) << k;
    if (next && slow_next) {
      EXPECT_NEAR(next->z_m, slow_next->z, 0.05e-6) << k;
    }
    (next ? met : escaped) += 1;
  }
  EXPECT_GT(met, 20);
  EXPECT_GT(escaped, 20);
}

TEST(Relief, EndsInEveryDirection) {
  const Relief r = random_relief(16, 16, 1e-6, 1e-6, 1e-7, 5);
  EXPECT_TRUE(r.met_from_above(3.3e-6, 2.2e-6, {0, 0, -1}));
  EXPECT_TRUE(r.met_from_above(-3e-6, 200e-6, {1, 0, -1e-9}));
  const auto hit = r.met_from_above(3.3e-6, 2.2e-6, {0, 0, -1});
  EXPECT_FALSE(r.met_from(*hit, {0, 0, 1}));
  const Relief flat(2, 2, 1, 1, {0, 0, 0, 0}, true);
  const auto on_flat = flat.met_from_above(0.5, 0.5, {0, 0, -1});
  ASSERT_TRUE(on_flat);
  EXPECT_FALSE(flat.met_from(*on_flat, {1, 0, 1e-300}));
  EXPECT_FALSE(flat.met_from(*on_flat, normalized(Vec3{1, 1e-9, 1e-15})));
}

TEST(Relief, MirroredTilesAreContinuousAndGapsAreFilledByAMembrane) {
  io::HeightMap map{5, 4, 1e-6, 2e-6, {}};
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x) map.z_m.push_back(1e-6 * x - 3e-7 * y);
  map.z_m[7] = std::nan("");
  map.z_m[11] = std::nan("");
  std::size_t missing = 0;
  const Relief r = relief_of(map, Tiling::mirrored, "t", &missing);
  EXPECT_EQ(missing, 2u);
  EXPECT_EQ(r.nx(), 8);
  EXPECT_EQ(r.ny(), 6);
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 8; ++i) {
      const int x = i < 5 ? i : 8 - i, y = 3 - (j < 4 ? j : 6 - j);
      EXPECT_NEAR(r.z_m(i, j), 1e-6 * x - 3e-7 * y, 1e-11);  // a plane is its own membrane
    }
  const io::HeightMap back = map_of(relief_of(map, Tiling::open, "t"));
  EXPECT_NEAR(back.z_m[3], map.z_m[3], 1e-15);
  EXPECT_EQ(back.width, 5u);
  for (std::size_t i = 0; i < 12; ++i) map.z_m[i] = std::nan("");
  EXPECT_THROW(relief_of(map, Tiling::open, "t"), Error);
}

TEST(Ridges, TheProfileIsASawWithRoundEdges) {
  RidgeShape s{.ridge_rad = 0.2, .pitch_m = 1e-4};
  const double c = std::cos(0.2), n = std::sin(0.2), facet = 1e-4 * c * c, depth = 1e-4 * c * n;
  EXPECT_NEAR(ridge_profile_m(s, 0), 0, 1e-18);
  EXPECT_NEAR(ridge_profile_m(s, facet), -depth, 1e-15);
  EXPECT_NEAR(ridge_profile_m(s, facet / 2), -depth / 2, 1e-15);
  EXPECT_NEAR(ridge_profile_m(s, facet + 0.5 * (1e-4 - facet)), -depth / 2, 1e-15);
  s.crest_radius_m = 4e-6, s.trough_radius_m = 7e-6;
  double last = ridge_profile_m(s, -1e-9), steepest = 0, least = 1;
  for (double y = 0; y < 3e-4; y += 1e-9) {  // continuous, and its slope stays between those of the flanks
    const double z = ridge_profile_m(s, y), slope = (z - last) / 1e-9;
    steepest = std::max(steepest, slope), least = std::min(least, slope);
    last = z;
  }
  EXPECT_NEAR(steepest, c / n, 1e-3 * c / n);
  EXPECT_NEAR(least, -n / c, 1e-3);
  EXPECT_NEAR(ridge_profile_m(s, 4e-6 * (c - n)), 4e-6 * (1 - n - c), 1e-12);  // the crest's highest point
  s.crest_radius_m = 2e-5;
  EXPECT_THROW(ridges(s), Error);
}

TEST(Ridges, BurrsCoverTheStatedShareOfTheCrests) {
  RidgeShape s{.ridge_rad = 0.15,
               .pitch_m = 1e-4,
               .burr_share = 0.3,
               .burr_height_m = 1e-6,
               .burr_width_m = 1e-5,
               .burr_length_m = 2e-5,
               .ridges = 4,
               .length_m = 4e-3,
               .seed = 3};
  const Relief r = ridges(s, {.across = 120, .along = 800});
  const double crest = ridge_profile_m(s, 0);
  int covered = 0;
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < r.nx(); ++i) covered += r.z_m(i, 120 * k) > crest + 1e-12;
  // some 285 burrs: 0.3 within 3 of their sigmas, 0.012
  EXPECT_NEAR(covered / (4.0 * r.nx()), 0.3, 0.06);
  s.seed = 4;
  EXPECT_NE(map_of(ridges(s, {.across = 120, .along = 800})).z_m, map_of(r).z_m);
}

}  // namespace
}  // namespace gonio::relief
