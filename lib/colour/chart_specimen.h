// Simulated photographs of charts: any pose, light that changes, offset, a lens's blur, noise; before a room that the
// caller paints. The camera's numbers are any 3 x 3 mixture of XYZ, so that what a correction should find is known
// exactly. For examples to try the program on, and for tests.
#pragma once
#include <cstdint>
#include <functional>

#include "colour/chart.h"
#include "colour/chart_pose.h"
#include "io/image.h"

namespace gonio::colour {

struct ChartSpecimen {
  ChartPose pose;
  Mat3 camera_from_xyz{{0.55, 0.4, 0.05, 0.15, 0.9, -0.05, 0.02, 0.1, 0.7}};
  double exposure = 1;
  Vec2 gradient{};            // of the light over the chart's width and height, 1 in its middle
  Rgb offset{};               // is added, times the exposure
  double shot = 0, read = 0;  // variance of a value v: shot v + read^2
  double blur_px = 0;         // sigma
  std::uint64_t seed = 1;
  std::function<Rgb(double x, double y)> room;  // what stands around the chart, px; left out: dark
};

// What even light without noise or offset gives of a patch.
Rgb read_of(const ChartSpecimen& specimen, const Patch& patch);
// The chart lies in a dark frame, as charts do.
io::Image photograph_of(const Chart& chart, const ChartSpecimen& specimen, int width, int height);

// A chart that leans a little, light that falls off by a tenth, a hundredth of white as glare, noise: 960 x 640.
ChartSpecimen example_specimen(const Chart& chart, std::uint64_t seed);
inline constexpr int example_width = 960, example_height = 640;

}  // namespace gonio::colour
