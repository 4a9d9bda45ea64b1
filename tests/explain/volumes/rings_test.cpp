// Rings: what other places of a circle show is told from noise, for gains that differ from pixel to pixel and for half
// a turn, which draws half rings.
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "explain/volumes/ball_mesh.h"
#include "explain/volumes/sites.h"

namespace gonio::explain::volumes {
namespace {

constexpr std::size_t side = 64;
constexpr double voxel = 1e-4, noise = 0.01;

// A ball of value one in air, and rings of independent gains for each voxel of radius, slice, and half of the turn.
struct RingScan {
  io::VolumeData volume;
  std::vector<double> gains;
  double ring_at(Vec3 p) const {
    const auto last = static_cast<double>(side) - 1;
    const double radius = std::hypot(p.x, p.y) / voxel, height = p.z / voxel + 0.5 * last;
    const auto r = static_cast<std::size_t>(radius), k = static_cast<std::size_t>(std::clamp(height, 0.0, last - 1));
    const double f = radius - std::floor(radius), g = height - static_cast<double>(k);
    const auto gain = [&](std::size_t rr, std::size_t kk) { return gains[(kk * side + rr) * 2 + (p.y > 0)]; };
    return (1 - g) * ((1 - f) * gain(r, k) + f * gain(r + 1, k)) +
           g * ((1 - f) * gain(r, k + 1) + f * gain(r + 1, k + 1));
  }
};

RingScan scan(const Body& body, double size) {
  RingScan s;
  Random random(11, 1);
  for (std::size_t n = 0; n < side * side * 2; ++n) s.gains.push_back(size * random.normal());
  s.volume.head.size = {side, side, side};
  s.volume.values.resize(side * side * side);
  const Sampled grid(s.volume, Vec3{voxel, voxel, voxel});
  for (std::size_t n = 0; n < s.volume.values.size(); ++n) {
    const Vec3 p = grid.place_of(
        {static_cast<double>(n % side), static_cast<double>(n / side % side), static_cast<double>(n / (side * side))});
    s.volume.values[n] = static_cast<float>(body.at(p) + s.ring_at(p) + noise * random.normal());
  }
  return s;
}

struct Told {
  double rms = 0, slope = 0, correlation = 0;
};

Told told(double size) {
  const double radius = 24 * voxel;
  const Body body = body_of(tests::ball_mesh({}, radius, false), {side, side, side},
                            Vec3{1, 1, 1} * (voxel * static_cast<double>(side)), "test");
  const RingScan s = scan(body, size);
  const Sampled sampled(s.volume, Vec3{voxel, voxel, voxel});
  std::vector<Row> rows;
  Random random(5, 1);
  while (rows.size() < 1500) {
    Row row;
    row.reading = Reading::inside;
    row.at_m = Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * radius;
    if (norm(row.at_m) < radius - 4 * voxel && std::hypot(row.at_m.x, row.at_m.y) > 5 * voxel) rows.push_back(row);
  }
  Told t;
  t.rms = add_rings(sampled, body, {0, 1, noise}, rows);
  double both = 0, own = 0, true_squares = 0;
  for (const Row& row : rows) {
    const double truth = s.ring_at(row.at_m);
    both += truth * row.ring, own += row.ring * row.ring, true_squares += truth * truth;
  }
  if (own > 0) t.slope = both / own / t.rms, t.correlation = both / std::sqrt(own * true_squares);
  return t;
}

// The best prediction has a slope of one; arcs that reach into the other half are held for noise, and take a little
// more than they ought to.
TEST(Rings, AreToldFromPixelToPixelAndHalfRingByHalfRing) {
  const Told t = told(0.01);
  EXPECT_GT(t.correlation, 0.65);
  EXPECT_GT(t.slope, 0.9);
  EXPECT_LT(t.slope, 1.4);
}

TEST(Rings, WhereThereAreNoneHardlyAnyIsTold) {
  EXPECT_LT(told(0).rms, 0.15 * noise);
}

}  // namespace
}  // namespace gonio::explain::volumes
