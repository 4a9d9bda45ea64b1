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

// Of lines apart by 6 to 16 pixels, in a lens a little out of focus.
TEST(Decode, LinesHaveTheErrorsThatTheyState) {
  for (const int period : {6, 8, 13}) {
    ScanWorld world;
    const Codes codes = tests::decoded(world, world.left, line_sequence(480, 360, both, period));
    for (const Axis axis : both) {
      const Errors e = errors_of(world, codes, axis);
      EXPECT_GT(e.told, 0.75 * e.all) << period;  // the others are the borders of the Gray code's stripes
      EXPECT_NEAR(e.square, 1, 0.3) << period << " " << static_cast<int>(axis);
      EXPECT_LT(std::abs(e.mean), 0.02) << period;
      EXPECT_LT(e.largest, 1) << period;
    }
    EXPECT_FALSE(codes.whole);
  }
}

// Projectors that are not linear: the exponent is found, and phases are as true as their sigmas say. Four shifts and
// more tell it, and three are straightened by it.
TEST(Decode, ABentProjectorIsFoundAndStraightened) {
  const double coarse[] = {1, 6}, fine[] = {40};
  for (const double gamma : {1.0, 1.4, 2.2})
    for (const int shifts : {4, 5, 8}) {
      ScanWorld world;
      world.gamma = gamma;
      Sequence s = cosine_sequence(480, 360, columns, coarse, shifts);
      for (const Shown& frame : cosine_sequence(480, 360, columns, fine, 3).frames) s.frames.push_back(frame);
      const Codes codes = tests::decoded(world, world.left, s);
      EXPECT_GT(codes.gamma_sigma, 0);
      EXPECT_LT(codes.gamma_sigma, shifts == 4 ? 0.05 : 0.01);
      EXPECT_NEAR(codes.gamma, gamma, 3 * codes.gamma_sigma) << shifts;
      const Errors e = errors_of(world, codes, Axis::column);
      EXPECT_GT(e.told, 0.95 * e.all) << gamma << " " << shifts;
      EXPECT_NEAR(std::sqrt(e.square), 1, 0.2) << gamma << " " << shifts;
    }
  ScanWorld bent;
  bent.gamma = 2.2;
  const double all[] = {1, 6, 40};
  const Errors three =
      errors_of(bent, tests::decoded(bent, bent.left, cosine_sequence(480, 360, columns, all, 3)), Axis::column);
  EXPECT_GT(std::sqrt(three.square), 3) << "three shifts alone do not tell it: the ripple stays";
  // Unless somebody knows it.
  DecodeRequest known;
  known.sequence = cosine_sequence(480, 360, columns, all, 3), known.width = bent.left.width;
  known.height = bent.left.height, known.noise = manifest::Noise{bent.gain, bent.read};
  known.gamma = 2.2, known.gamma_sigma = 0.01;
  const tests::Recorder recorder(bent, bent.left, known.sequence);
  known.read = [&](std::size_t frame) { return recorder(frame); };
  const Errors straight = errors_of(bent, decode(known), Axis::column);
  EXPECT_LT(std::sqrt(straight.square), 1.3);
}

TEST(Decode, NothingOnAPlaneIsTakenForLightFromElsewhere) {
  ScanWorld world;
  const double coarse_to_fine[] = {1, 8, 64}, heterodyne[] = {36, 33, 31};
  for (const Sequence& s : {gray_sequence(480, 360, both), cosine_sequence(480, 360, both, coarse_to_fine, 4),
                            cosine_sequence(480, 360, both, heterodyne, 4)})
    EXPECT_EQ(std::ranges::count(tests::decoded(world, world.left, s).refusal, Refusal::interreflection), 0);
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
