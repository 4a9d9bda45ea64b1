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

struct ChartLight {
  Rgb offset{};        // codes of the picture
  Vec2 gradient{};     // relative change along the chart's width and its height
  Rgb offset_sigma{};  // one standard deviation each
  Vec2 gradient_sigma{};
  Vec3 curve{}, curve_sigma{};
  double offset_chance = 1, gradient_chance = 1,
         curve_chance = 1;  // that even light without offset would look like that (F test)

  Rgb evened(Rgb read, Vec2 place) const;   // what even light without offset would have given
  double relative_light(Vec2 place) const;  // 1 in the middle of the chart
  double evenness() const;                  // least light on the chart over the most; 0 or less: no lamp does that
};

struct LightRequest {
  bool offset = true, gradient = true, curve = false;  // which are fitted; the others are zero
};

// `white`: what a perfect white reads, about. Readings that are left out do not count, nor does `without`. Where the
// chart's greys are fewer than four, or all of about one lightness, no offset is found: zero, with chance 1.
ChartLight chart_light(const Chart& chart, std::span<const PatchReading> readings, Rgb white,
                       const LightRequest& request, std::optional<std::size_t> without = {});

// What a perfect white reads: from the greys, or from all patches where there are fewer than two. Error(data) at
// `place` where no patch counts or none is brighter than nothing.
Rgb white_of(const Chart& chart, std::span<const PatchReading> readings, const std::string& place);

}  // namespace gonio::colour
