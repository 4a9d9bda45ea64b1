// From what a network sees to what it says.
//
// Channels, named as render(1) names the truth; the camera's frame (x right, y down, z forward):
//   mask                        probability that the pixel meets the object
//   depth.Z                     along the camera's axis, m
//   normal.X/Y/Z                of the front, unit
//   back_normal.X/Y/Z           of the back, outward, unit; where the network learnt it
//   uncertainty.depth.Z         m      of each 68.3 % of what is like the validation share err by less; left out where
//   uncertainty.normal          rad    the weights say nothing of their errors
//   uncertainty.back_normal     rad
#pragma once
#include "glass/net/seen.h"
#include "glass/net/weights.h"
#include "io/image.h"

namespace gonio::glass {

inline constexpr double uncertainty_level = 0.683;

// `seen` in mean light. Pictures of more than `tile_px` pixels a side are taken in tiles, which overlap as far as the
// network looks: what comes out is the same. Error(data) where the network does not fit its record.
io::Image answer_of(const Weights& weights, const Planes& seen, int tile_px = 1024);

// As many pixels as the photograph has, between the centres of blocks of `shrink` pixels; depth, normals and
// uncertainties are 0 where mask < 1/2.
io::Image as_photographed(const io::Image& answer, int shrink, int width, int height);

}  // namespace gonio::glass
