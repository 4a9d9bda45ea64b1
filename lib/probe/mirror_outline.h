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
// estimates with weights (sandwich), summed over sectors within which neighbours share their errors.
//
// What no scatter shows: where the surroundings behind the ball go on in their reflection, the edge that one finds lies
// within the outline, by 0.4 to 1.1 px of radius and up to 1.4 px to a side in simulated rooms: `squeeze`. Silhouettes
// have no such step; those that were decided pixel by pixel are in doubt by `drawn`.
#pragma once
#include <optional>

#include "camera/camera_model.h"
#include "io/grey.h"
#include "reassembly/outline.h"

namespace gonio::probe {

struct Doubt {  // one standard deviation that all of an outline shares
  double radius_px = 0, centre_px = 0;
};
inline constexpr Doubt squeeze{0.8, 0.6}, drawn{0.5, 0.2};
void add_doubt(reassembly::Outline& outline, Doubt doubt);

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
