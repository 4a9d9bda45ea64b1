// Rims of regions in photographs, at fractions of a pixel, as points with normals.
//
// A region is a picture of shares: 1 inside, 0 outside, and between where a pixel holds both. A binary mask's staircase
// is smoothed by a Gaussian first, whose half level then runs along the rim: exactly on a straight one, and sigma^2 /
// (2 r) inside of it where the rim is bent with radius r, which is undone as far as the points tell r. Points stand
// about a pixel apart; pixel centres lie at integers.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "geom/vector.h"

namespace gonio::alignment {

struct RimPoint {
  Vec2 pixel, outward;     // outward: unit, out of the region
  double sigma_px = 0.3;   // of the normal offset, as far as somebody knows
  std::uint32_t loop = 0;  // of the rim; points of one stand in order
  double arc_px = 0;       // along the loop
  bool counts = true;      // false: something else meets it here, so that this is no rim of the region's own
};

struct Region {
  int width = 0, height = 0;
  std::vector<float> share;          // per pixel
  std::vector<std::uint8_t> no_rim;  // per pixel, or empty: rims within `margin_px` of such a pixel do not count
  double margin_px = 3;
};

// Loops shorter than `least_px` are specks, and left out. Rims that the picture's border cuts off end there: points
// within two pixels of it do not count.
std::vector<RimPoint> rim_points(const Region& region, double smooth_px, double least_px);

// The points where the lens puts them without distortion, normals turned along. `straighten`: of one pixel.
void straighten(std::vector<RimPoint>& points, const std::function<Vec2(Vec2)>& straight);

}  // namespace gonio::alignment
