// Photographs of charts, simulated for tests: any pose, uneven light, offset, a lens's blur, noise, a cluttered room.
// The camera's matrix is any 3 x 3; what it should see is known exactly.
#pragma once
#include <array>
#include <cstdint>

#include "colour/chart.h"
#include "colour/chart_pose.h"
#include "io/image.h"

namespace gonio::colour {

struct Photograph {
  ChartPose pose;
  Mat3 camera{{0.55, 0.4, 0.05, 0.15, 0.9, -0.05, 0.02, 0.1, 0.7}};  // camera's R, G, B from XYZ under D50
  double exposure = 1;
  Vec2 gradient{};            // of the light over the chart's width and height
  Rgb offset{};               // of the camera's numbers over exposure
  double shot = 0, read = 0;  // variance of v: shot v + read^2
  double blur_px = 0;         // sigma
  bool clutter = false;
  std::uint64_t seed = 1;
};

// What even light without noise or offset gives of a patch.
Rgb seen(const Photograph& photograph, const Patch& patch);
io::Image photograph_of(const Chart& chart, const Photograph& photograph, int width, int height);

// A pose as a hand gives one: turned any way, tilted by up to 45 degrees, from a fifth of the picture to most of it.
ChartPose random_pose(const Chart& chart, int width, int height, std::uint64_t seed);

}  // namespace gonio::colour
