// Where a camera sees the projector's pixels: errors along x and y against what is stated of each, where columns are
// told worse than rows.
#include "scan/code_places.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scan/scan_world.h"

namespace gonio::scan {
namespace {

TEST(CodePlaces, HaveTheErrorsThatTheyStateInEachCoordinate) {
  const tests::ScanWorld world;
  constexpr Axis both[] = {Axis::column, Axis::row};
  const double periods[] = {1, 6, 40};  // of 12 columns and of 9 rows each
  const Codes codes = tests::decoded(world, world.left, cosine_sequence(480, 360, both, periods, 4));
  Vec2 squares, stated;
  double count = 0;
  for (const CodePlace& p : places_of(codes, 480)) {
    const auto met =
        tests::met(world, world.projector, static_cast<double>(p.code % 480), static_cast<double>(p.code / 480));
    const auto truth = world.left.pixel(met);
    if (truth[0] < 5 || truth[1] < 5 || truth[0] > 314 || truth[1] > 234 || p.variance_px2.x > 0.01) continue;
    squares = squares + Vec2{std::pow(p.pixel.x - truth[0], 2), std::pow(p.pixel.y - truth[1], 2)};
    stated = stated + p.variance_px2, ++count;
  }
  EXPECT_GT(count, 50000);
  EXPECT_NEAR(std::sqrt(squares.x / stated.x), 1, 0.05);
  EXPECT_NEAR(std::sqrt(squares.y / stated.y), 1, 0.05);
  EXPECT_GT(squares.x, 1.3 * squares.y);
}

}  // namespace
}  // namespace gonio::scan
