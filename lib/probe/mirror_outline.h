// The outline of a mirror ball among the edges near a start: which of them lie on one cone.
//
// What a mirror shows next to its outline is the surroundings, squeezed against it: streaks run along the outline at
// any distance within, things behind the ball end at it or do not, and the step across it changes its sign and vanishes
// in places. No profile is assumed therefore. Along the normals of the start, extrema of the gradient (derivative of a
// Gaussian of one pixel) are edges, each with a strength s = g / (g + g0), g0 the typical gradient; the cone is wanted
// with the largest
//   sum over edges of s exp(-r^2 / (2 w^2)),   r the edge's distance from the outline, px,
// first on a grid over the search range, then by reweighted least squares with w falling from 2 to 0.7 px (a
// redescending M-estimator: Holland & Welsch, Communications in Statistics A 6, 1977). The covariance is that of
// estimates with weights (sandwich), summed over sectors within which neighbours share their errors, and on top of it
// what no scatter shows: half a pixel within the outline a ball of some hundred pixels still shows what lies within ten
// degrees of straight behind it, so that the step seems to lie up to 0.7 px inwards. `squeeze_px` of radius and a
// quarter of it of each coordinate are one standard deviation of that.
#pragma once
#include <optional>

#include "camera/camera_model.h"
#include "io/grey.h"
#include "reassembly/outline.h"

namespace gonio::probe {

inline constexpr double squeeze_px = 0.5;

struct OutlineSearch {
  Vec3 axis;  // unit, camera frame: the start
  double half_angle_rad = 0;
  double range = 0.1;  // how far centre and radius may be off, as a share of the radius; at most 0.25
};
// `grey` has values, not bytes alone. `counts`: pixels that may be looked at, empty: all. Nothing where the edges
// determine no cone.
std::optional<reassembly::Outline> mirror_outline(const io::GreyImage& grey, const camera::CameraModel& camera,
                                                  const OutlineSearch& start, const std::vector<unsigned char>& counts);

}  // namespace gonio::probe
