// Corners of squares to hundredths of a pixel. For sources of this folder only: the types are OpenCV's.
//
// A corner between four squares is the product of two blurred edges,
//   I(p) = m + g . p + c E(n1 . (p - x) / s1) E(n2 . (p - x) / s2),   E(z) = erf(z / sqrt 2),
// with the corner x, the edges' directions n1, n2 and blurs s1, s2 (which may differ: motion), the contrast c and a
// plane of illumination (m, g). Its ten parameters are fitted by Levenberg-Marquardt to the pixels along both edges
// that stay clear of anything else printed near by: along each edge as far as its own side of a square allows, across
// it as far as the blur has spread it, which a first fit tells. All pixels count alike, and lines keep their places
// where the brightness scale is bent, because the pattern is symmetric about x: a photograph need not be linearised.
// The fit also says how well it knows x. cv::cornerSubPix makes the start; its own result scatters more, and by 0.05 px
// and more at sharp edges.
//
// Does not know lenses: edges are straight within the reach, at most 12 px or four blurs, over which a lens bends them
// by hundredths of a pixel.
#pragma once
#include <opencv2/core.hpp>
#include <vector>

#include "camera/corner_detection.h"

namespace gonio::camera {

// A predicted corner, and where the next corners to its right and below it would be relative to it.
struct Prediction {
  int id = 0;
  cv::Point2d pixel, along_columns, along_rows;  // one square along the columns (x) and along the rows (y)
  int bare = 0;  // squares without other ink: 1 the upper left and lower right ones, -1 the other two, 0 all four
  double square_px() const { return std::min(cv::norm(along_columns), cv::norm(along_rows)); }
};

// Refined corners, sorted by id. `values`: grey, 8 bit or float, one channel. `clear_share`: how far from an edge, in
// squares, other ink begins where there is any. Dropped are corners whose surroundings leave the picture, that move by
// more than a quarter of a square from their prediction, or whose surroundings are not two edges that cross: covered,
// glared or blurred away.
std::vector<Corner> refine(const cv::Mat& values, const std::vector<Prediction>& predictions, double clear_share,
                           const DetectionOptions& options);

}  // namespace gonio::camera
