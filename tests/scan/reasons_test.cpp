// Why pixels are refused: what moved, what spreads light beneath its surface, what two places say they show.
#include <gtest/gtest.h>

#include <algorithm>

#include "scan/decode.h"
#include "scan/scan_world.h"

namespace gonio::scan {
namespace {

using tests::ScanWorld;

constexpr Axis both[] = {Axis::column, Axis::row};
constexpr double periods[] = {1, 6, 40};

// Of pixels that are lit: how many were refused for a reason, left of `edge_px` and right of it.
struct Sides {
  double left = 0, right = 0;
};
Sides refused(const Codes& codes, const Codes& untouched, Refusal reason, int edge_px) {
  Sides found;
  double of_left = 0, of_right = 0;
  for (std::size_t i = 0; i < codes.refusal.size(); ++i) {
    if (!untouched.told(i)) continue;
    const bool left = static_cast<int>(i) % codes.width < edge_px;
    (left ? of_left : of_right) += 1;
    if (codes.refusal[i] == reason) (left ? found.left : found.right) += 1;
  }
  return {found.left / of_left, found.right / of_right};
}

// Decoded, with what the camera reads left of `edge_px` changed: light less ambient, by frame and pixel.
template <class Change>
Codes changed(const ScanWorld& world, const Sequence& sequence, int edge_px, const Change& change) {
  const tests::Recorder recorder(world, world.left, sequence);
  DecodeRequest r;
  r.sequence = sequence, r.width = world.left.width, r.height = world.left.height;
  r.noise = manifest::Noise{world.gain, world.read};
  r.read = [&](std::size_t frame) {
    CameraFrame f = recorder(frame);
    for (std::size_t i = 0; i < f.light.size(); ++i)
      if (static_cast<int>(i) % r.width < edge_px)
        f.light[i] = static_cast<float>(world.ambient + change(frame, f.light[i] - world.ambient));
    return f;
  };
  return decode(r);
}

TEST(Reasons, WhatMovedIsRefusedAndWhatStoodIsKept) {
  const ScanWorld world;
  for (const Sequence& sequence : {gray_sequence(480, 360, both), cosine_sequence(480, 360, both, periods, 5)}) {
    const auto none = [](std::size_t, double v) { return v; };
    // Something else comes before it after four tenths of the frames, a third as bright and thrice.
    for (const double brightness : {0.3, 3.0}) {
      const auto other = [&](std::size_t frame, double v) {
        return 10 * frame > 4 * sequence.frames.size() ? brightness * v : v;
      };
      const Codes still = changed(world, sequence, 150, none), moved = changed(world, sequence, 150, other);
      const Sides s = refused(moved, still, Refusal::motion, 150);
      EXPECT_GT(s.left, 0.9);
      EXPECT_LT(s.right, 1e-4);
    }
  }
}

// Exposed two and a half times too long: sums of readings that are full are less than they should be.
TEST(Reasons, WhatIsFullDidNotMove) {
  const ScanWorld world;
  const Sequence sequence = gray_sequence(480, 360, both);
  const tests::Recorder recorder(world, world.left, sequence);
  DecodeRequest r;
  r.sequence = sequence, r.width = world.left.width, r.height = world.left.height;
  r.noise = manifest::Noise{world.gain, world.read};
  r.read = [&](std::size_t frame) {
    CameraFrame f = recorder(frame);
    f.saturated.assign(f.light.size(), 0);
    for (std::size_t i = 0; i < f.light.size(); ++i) {
      // Some of it by way of other things, whatever is shown.
      f.light[i] = 2.5f * f.light[i] + (sequence.frames[frame].what == Shown::What::black ? 0.0f : 0.3f);
      if (f.light[i] >= 1) f.light[i] = 1, f.saturated[i] = 1;
    }
    return f;
  };
  EXPECT_EQ(std::ranges::count(decode(r).refusal, Refusal::motion), 0);
}

TEST(Reasons, CosinesThatAThingLosesAreRefused) {
  const ScanWorld world;
  const Sequence sequence = cosine_sequence(480, 360, both, periods, 5);
  double mean = 0.5 * world.white;
  // The finest cosines keep a seventh of their amplitude.
  const auto spread = [&](std::size_t frame, double v) {
    return sequence.frames[frame].periods == 40 ? mean + (v - mean) / 7 : v;
  };
  ScanWorld even = world;
  even.tilt = 0;
  const Codes opaque = changed(even, sequence, 150, [](std::size_t, double v) { return v; }),
              translucent = changed(even, sequence, 150, spread);
  EXPECT_EQ(refused(opaque, opaque, Refusal::subsurface, 150).left, 0);
  const Sides s = refused(translucent, opaque, Refusal::subsurface, 150);
  EXPECT_GT(s.left, 0.9);
  EXPECT_EQ(s.right, 0);
}

}  // namespace
}  // namespace gonio::scan
