// See chart_pose.h.
#include "colour/chart_pose.h"

#include <cmath>

#include "base/error.h"
#include "base/text.h"

namespace gonio::colour {
namespace {

double turn(Vec2 a, Vec2 b, Vec2 c) {
  return (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x);
}

}  // namespace

Vec2 ChartPose::at(Vec2 chart) const {
  const Vec3 h = image_from_chart * Vec3{chart.x, chart.y, 1};
  return {h.x / h.z, h.y / h.z};
}

ChartPose pose_from_corners(const std::array<Vec2, 4>& c, const std::string& place) {
  int right = 0, left = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double t = turn(c[i], c[(i + 1) % 4], c[(i + 2) % 4]);
    right += t > 1, left += t < -1;
  }
  if (left == 4)
    throw Error(Exit::usage, place, "go counter-clockwise, as in a mirrored picture",
                "start at the first patch and go clockwise as the chart is read");
  if (right != 4)
    throw Error(Exit::usage, place, "are not the corners of a convex quadrilateral",
                "start at the first patch and go clockwise around the chart");
  // Heckbert 1989, "Fundamentals of texture mapping and image warping", 2.2.3: square to quadrilateral.
  const Vec2 d1 = c[1] - c[2], d2 = c[3] - c[2], sum = c[0] - c[1] + c[2] - c[3];
  const double below = d1.x * d2.y - d2.x * d1.y;
  const double g = (sum.x * d2.y - d2.x * sum.y) / below, h = (d1.x * sum.y - sum.x * d1.y) / below;
  return {{{c[1].x - c[0].x + g * c[1].x, c[3].x - c[0].x + h * c[3].x, c[0].x, c[1].y - c[0].y + g * c[1].y,
            c[3].y - c[0].y + h * c[3].y, c[0].y, g, h, 1}}};
}

std::array<Vec2, 4> corners_of(const ChartPose& pose) {
  return {pose.at({0, 0}), pose.at({1, 0}), pose.at({1, 1}), pose.at({0, 1})};
}

std::array<Vec2, 4> outline_of(const ChartPose& pose, const Patch& patch, double share) {
  const Vec2 half = patch.size * (share / 2), c = patch.centre;
  return {pose.at(c - half), pose.at({c.x + half.x, c.y - half.y}), pose.at(c + half),
          pose.at({c.x - half.x, c.y + half.y})};
}

}  // namespace gonio::colour
