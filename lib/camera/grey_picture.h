// Grey pictures as OpenCV sees them. For sources of this folder only: the types are OpenCV's.
#pragma once
#include <opencv2/core.hpp>

#include "io/grey.h"

namespace gonio::camera {

struct GreyPicture {  // without pixels of its own: the picture it was made of must stay
  cv::Mat values;     // 0 to 255; CV_8U, or CV_32F where the picture says more than bytes can
  cv::Mat bytes;      // CV_8U
};
GreyPicture grey_picture(const io::GreyImage& image);

// The picture reduced until its longer side is at most `longest_px`, and where its pixel centres lie: full = scale * (p
// + 0.5) - 0.5.
struct Reduced {
  cv::Mat bytes;
  double scale = 1;
  cv::Point2d to_full(cv::Point2d p) const { return {scale * (p.x + 0.5) - 0.5, scale * (p.y + 0.5) - 0.5}; }
};
Reduced reduced(const GreyPicture& picture, int longest_px);

}  // namespace gonio::camera
