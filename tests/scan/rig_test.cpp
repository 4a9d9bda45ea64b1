// Rigs of more than two devices, and pixels of the projector that a camera seems to see in two places.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "scan/code_places.h"
#include "scan/scan_world.h"

namespace gonio::scan {
namespace {

using tests::Pinhole;
using tests::ScanWorld;

constexpr Axis both[] = {Axis::column, Axis::row};

struct Off {
  double rms = 0, stated = 0, bias = 0;
};
// Along the surface's normal.
Off off_of(const ScanWorld& world, const Cloud& cloud) {
  Off o;
  double count = 0;
  for (const ScanPoint& p : cloud.points) {
    const double off = tests::off_shape(world, {p.position_m.x, p.position_m.y, p.position_m.z});
    const double slope = std::hypot(1.0, world.tilt), nx = world.tilt / slope, nz = -1 / slope;
    const double variance = nx * nx * p.covariance[0] + 2 * nx * nz * p.covariance[2] + nz * nz * p.covariance[5];
    o.rms += off * off, o.stated += variance, o.bias += off, ++count;
  }
  return {std::sqrt(o.rms / count), std::sqrt(o.stated / count), o.bias / count};
}

// Root mean squares of both, where the first camera has the same place.
std::pair<double, double> of_common_pixels(const ScanWorld& world, const Cloud& a, const Cloud& b) {
  const auto off = [&world](const ScanPoint& p) {
    return tests::off_shape(world, {p.position_m.x, p.position_m.y, p.position_m.z});
  };
  std::map<std::pair<double, double>, double> first;
  for (const ScanPoint& p : a.points) first[{p.pixel.x, p.pixel.y}] = off(p);
  double of_a = 0, of_b = 0;
  for (const ScanPoint& p : b.points) {
    const auto same = p.camera == 0 ? first.find({p.pixel.x, p.pixel.y}) : first.end();
    if (same != first.end()) of_a += same->second * same->second, of_b += off(p) * off(p);
  }
  return {std::sqrt(of_a), std::sqrt(of_b)};
}

TEST(Rig, MoreDevicesTellMoreAndStateIt) {
  const ScanWorld world;
  const double periods[] = {1, 6, 40};
  const Sequence s = cosine_sequence(480, 360, both, periods, 4);
  const Pinhole above{320, 240, 640, {0.01, -0.1, 0.02}, 0};
  const Codes left = tests::decoded(world, world.left, s), right = tests::decoded(world, world.right, s),
              third = tests::decoded(world, above, s);
  const Look looks[] = {{&left, tests::station_of(world.left)},
                        {&right, tests::station_of(world.right)},
                        {&third, tests::station_of(above)}};
  const Station projector = tests::station_of(world.projector);
  const Cloud clouds[] = {points_of_rig(std::span(looks).first(2), nullptr, 480), points_of_rig(looks, nullptr, 480),
                          points_of_rig(std::span(looks).first(2), &projector, 480)};
  for (std::size_t k = 0; k < 3; ++k) {
    const Off off = off_of(world, clouds[k]);
    EXPECT_NEAR(off.rms / off.stated, 1, 0.2) << k;
    EXPECT_LT(std::abs(off.bias), 0.2 * off.stated) << k;
    EXPECT_NEAR(clouds[k].epipolar_chi_square, 1, 0.25) << k;
  }
  // Points of the same pixels of the projector are better for a camera more, and no worse for a projector that stands
  // in the middle between the two: its ray and the left one, and its ray and the right one, tell what both cameras do.
  for (std::size_t k = 1; k < 3; ++k) {
    const auto [of_two, of_more] = of_common_pixels(world, clouds[0], clouds[k]);
    EXPECT_LT(of_more, (k == 1 ? 0.97 : 1.02) * of_two) << k;
  }
  // Some are seen by the right camera first.
  EXPECT_GT(clouds[1].points.size(), clouds[0].points.size());
  std::size_t by_others = 0;
  for (const ScanPoint& p : clouds[1].points) by_others += p.camera != 0;
  EXPECT_GT(by_others, 0u);
}

TEST(Rig, APixelOfTheProjectorIsSeenInOnePlace) {
  const ScanWorld world;
  const double periods[] = {1, 6, 40};
  const Sequence s = cosine_sequence(480, 360, both, periods, 4);
  Codes codes = tests::decoded(world, world.left, s);
  EXPECT_EQ(ambiguous_pixels(codes, 480).size(), 0u);
  // Single pixels that tell what others tell 83 pixels away.
  std::size_t wrong = 0, found = 0;
  const auto width = static_cast<std::size_t>(codes.width);
  for (std::size_t y = 20; y < 220; y += 8)
    for (std::size_t x = 20; x < 160; x += 8) {
      const std::size_t i = y * width + x, other = i + 83;
      if (!codes.told(i) || !codes.told(other)) continue;
      for (std::size_t axis = 0; axis < 2; ++axis) codes.place[axis][i] = codes.place[axis][other];
      ++wrong;
    }
  const std::vector<std::uint32_t> ambiguous = ambiguous_pixels(codes, 480);
  for (const std::uint32_t p : ambiguous)
    found += p % width < 160 && (p % width - 20) % 8 == 0 && (p / width - 20) % 8 == 0;
  EXPECT_GT(wrong, 200u);
  EXPECT_GT(static_cast<double>(found), 0.98 * static_cast<double>(wrong));
  EXPECT_LE(ambiguous.size() - found, 0.02 * static_cast<double>(wrong));
}

}  // namespace
}  // namespace gonio::scan
