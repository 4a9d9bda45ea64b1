// From frames to the projector's pixel: errors against their sigma, noise that is found, and what is refused for which
// reason. Seeds are fixed; bounds on means of squares hold by chance with 99.9 %.
#include "scan/decode.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scan/scan_world.h"

namespace gonio::scan {
namespace {

using tests::ScanWorld;

constexpr Axis both[] = {Axis::column, Axis::row};
constexpr Axis columns[] = {Axis::column};

struct Errors {
  double square = 0, mean = 0, largest = 0;  // over sigma; of columns in pixels
  int told = 0, all = 0;
};

Errors errors_of(const ScanWorld& world, const Codes& codes, Axis axis) {
  Errors e;
  const auto a = static_cast<std::size_t>(axis);
  for (int y = 0; y < codes.height; ++y)
    for (int x = 0; x < codes.width; ++x) {
      const auto truth = tests::lit_by(world, world.left, x, y);
      if (truth[0] < 2 || truth[1] < 2 || truth[0] > world.projector.width - 3 || truth[1] > world.projector.height - 3)
        continue;
      ++e.all;
      const auto i = static_cast<std::size_t>(y * codes.width + x);
      if (!codes.told(i)) continue;
      ++e.told;
      const double off = codes.place[a][i] - truth[a];
      e.square += std::pow(off / codes.sigma[a][i], 2), e.mean += off;
      e.largest = std::max(e.largest, std::abs(off));
    }
  e.square /= e.told, e.mean /= e.told;
  return e;
}

TEST(Decode, CosinesHaveTheErrorsThatTheyState) {
  ScanWorld world;
  const double periods[] = {1, 6, 40};
  const Codes codes = tests::decoded(world, world.left, cosine_sequence(480, 360, both, periods, 5));
  for (const Axis axis : both) {
    const Errors e = errors_of(world, codes, axis);
    EXPECT_GT(e.told, 0.98 * e.all);
    EXPECT_NEAR(e.square, 1, 0.1) << static_cast<int>(axis);
    EXPECT_LT(std::abs(e.mean), 0.02);
    EXPECT_LT(e.largest, 2);  // nowhere a wrong period, which is 12 pixels wide
  }
}

TEST(Decode, SeveralFinePeriodsTellAPixelTogether) {
  ScanWorld world;
  const double heterodyne[] = {36, 33, 31}, micro[] = {30, 31.5, 33, 34};
  for (const std::span<const double> periods : {std::span<const double>(heterodyne), std::span<const double>(micro)}) {
    const Codes codes = tests::decoded(world, world.left, cosine_sequence(480, 360, columns, periods, 4));
    const Errors e = errors_of(world, codes, Axis::column);
    EXPECT_GT(e.told, 0.9 * e.all);
    EXPECT_LT(e.largest, 3);
  }
}

TEST(Decode, BitsTellTheStripe) {
  ScanWorld world;
  const Codes codes = tests::decoded(world, world.left, gray_sequence(480, 360, both));
  for (const Axis axis : both) {
    const Errors e = errors_of(world, codes, axis);
    EXPECT_GT(e.told, 0.5 * e.all);
    EXPECT_LT(e.largest, 1.1);  // a pixel of the camera is wider than a stripe here and there
    EXPECT_NEAR(e.square, 1, 0.35);
  }
  EXPECT_TRUE(codes.whole);
}

TEST(Decode, NoiseIsFoundInTheFrames) {
  ScanWorld world;
  const double periods[] = {1, 6, 40};
  for (const Sequence& s : {gray_sequence(480, 360, both), cosine_sequence(480, 360, both, periods, 4)}) {
    const manifest::Noise found = tests::decoded(world, world.left, s, false).noise;
    for (const double light : {0.4}) {  // what all pixels read in the mean: nothing else was seen
      const double truth = std::sqrt(light / world.gain + world.read * world.read),
                   own = std::sqrt((found.gain > 0 ? light / found.gain : 0) + found.read * found.read);
      EXPECT_NEAR(own / truth, 1, 0.15) << light << " " << found.gain << " " << found.read;
    }
  }
}

TEST(Decode, WhatIsNotToldSaysWhy) {
  ScanWorld world;
  world.shape = ScanWorld::Shape::ball;
  const double periods[] = {1, 6, 40};
  const Sequence cosines = cosine_sequence(480, 360, both, periods, 4);
  const auto share = [](const Codes& c, Refusal r) {
    return static_cast<double>(std::ranges::count(c.refusal, r)) / static_cast<double>(c.refusal.size());
  };
  const Codes ball = tests::decoded(world, world.left, cosines);
  EXPECT_GT(share(ball, Refusal::dark), 0.6);  // beside the ball
  EXPECT_LT(share(ball, Refusal::contradictory), 0.02);
  world.white = 1.4;
  EXPECT_GT(share(tests::decoded(world, world.left, cosines), Refusal::saturated), 0.1);
  EXPECT_EQ(share(tests::decoded(world, world.left, gray_sequence(480, 360, both)), Refusal::saturated), 0);
  DecodeRequest request;
  request.sequence = cosines, request.width = 320, request.height = 240;
  request.mask.assign(320 * 240, 0);
  const tests::Recorder recorder(world, world.left, cosines);
  request.read = [&](std::size_t f) { return recorder(f); };
  EXPECT_EQ(share(decode(request), Refusal::masked), 1);
}

}  // namespace
}  // namespace gonio::scan
