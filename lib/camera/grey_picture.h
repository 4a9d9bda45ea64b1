// Grey pictures for detection and the refinement of corners on them. For sources of this folder only: the types are
// OpenCV's.
#pragma once
#include <opencv2/core.hpp>
#include <vector>

#include "camera/corner_detection.h"
#include "io/image.h"

namespace gonio::camera {

struct GreyPicture {
  cv::Mat values;  // CV_32F, 0 to 255
  cv::Mat bytes;   // CV_8U, the same rounded
};
// Luminance weights 0.299, 0.587, 0.114 as for 8-bit video. Values beyond [0, 1] are scaled by their 99.5th percentile.
GreyPicture grey_picture(const io::Image& image);

// The picture reduced until its longer side is at most `longest_px`, and where its pixel centres lie: full = scale * (p
// + 0.5) - 0.5.
struct Reduced {
  cv::Mat bytes;
  double scale = 1;
  cv::Point2d to_full(cv::Point2d p) const { return {scale * (p.x + 0.5) - 0.5, scale * (p.y + 0.5) - 0.5}; }
};
Reduced reduced(const GreyPicture& picture, int longest_px);

// A predicted corner and the side of a square there.
struct Prediction {
  int id = 0;
  cv::Point2d pixel;
  double square_px = 0;
};
// Refined corners, within a half-window of `window_share` squares unless the options fix it; those that leave the
// picture or move by more than a quarter of a square from their prediction are dropped.
std::vector<Corner> refine(const GreyPicture& picture, const std::vector<Prediction>& predictions, double window_share,
                           const DetectionOptions& options);

}  // namespace gonio::camera
