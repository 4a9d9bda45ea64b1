// Where a chart lies in a picture: the homography from its own coordinates (colour/chart.h) to pixels.
#pragma once
#include <array>
#include <string>

#include "colour/chart.h"
#include "geom/vector.h"

namespace gonio::colour {

struct ChartPose {
  Mat3 image_from_chart;  // (x, y) = (h0 / h2, h1 / h2) of h = M (u, v, 1); pixel centres lie at integers
  Vec2 at(Vec2 chart) const;
};

// From the outer corners of the patches at the chart's corners, in this order: of the first patch, then clockwise as
// the chart is read. Error(usage) at `place` for corners that are no convex quadrilateral or go the other way round,
// which is a mirrored picture.
ChartPose pose_from_corners(const std::array<Vec2, 4>& corners, const std::string& place);
std::array<Vec2, 4> corners_of(const ChartPose& pose);

// Corners of one patch's coloured area, shrunk about its centre to `share` of its width, in pixels.
std::array<Vec2, 4> outline_of(const ChartPose& pose, const Patch& patch, double share);

}  // namespace gonio::colour
