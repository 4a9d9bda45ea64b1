// What lies between a chart's colours and what a camera read of them beside the camera's colours: light that falls off
// across the chart, and light or black level that was added to all of it.
//
//   read_c(p) = (1 + gradient . d + curve . (d_u^2, d_u d_v, d_v^2)) (A rgb(p))_c + offset_c,   d = (u - 1/2, v - 1/2)
//
// with rgb the reference and A any 3 x 3 matrix. A lamp far away at a slant gives a gradient, a near one curves. Greys
// tell the offset: a camera sees them in proportion to their reflectance, as it does not see other colours, whose
// misfit to A is taken as 6 % and as noise between patches. Robust least squares (Huber). Veiling glare and a black
// level that is not zero look the same here.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "colour/chart.h"
#include "colour/patch_readings.h"

namespace gonio::colour {

// What was fitted, each with one standard deviation; the others are zero. Chances are of even light without offset to
// look like that (F test).
struct ChartLight {
  Rgb offset{}, offset_sigma{};       // in the picture's unit
  Vec2 gradient{}, gradient_sigma{};  // relative change along the chart's width and its height
  Vec3 curve{}, curve_sigma{};        // second order: width^2, width height, height^2
  double offset_chance = 1, gradient_chance = 1, curve_chance = 1;

  Rgb evened(Rgb read, Vec2 place) const;   // what even light without offset would have given
  double relative_light(Vec2 place) const;  // 1 in the middle of the chart
  double evenness() const;                  // least light on the chart over the most; 0 or less: no lamp does that
};

struct LightRequest {
  bool offset = true, gradient = true, curve = false;
};

// `white`: what a perfect white reads, about. Readings that are left out do not count, nor does `without`. Where the
// chart's greys are fewer than four, or all of about one lightness, no offset is found: zero, with chance 1.
ChartLight chart_light(const Chart& chart, std::span<const PatchReading> readings, Rgb white,
                       const LightRequest& request, std::optional<std::size_t> without = {});

// What a perfect white reads: from the greys, or from all patches where there are fewer than two. Error(data) at
// `place` where no patch counts or none is brighter than nothing.
Rgb white_of(const Chart& chart, std::span<const PatchReading> readings, const std::string& place);

}  // namespace gonio::colour
