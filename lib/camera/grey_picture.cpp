// Views of pictures, and their reduction.
#include "camera/grey_picture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace gonio::camera {

GreyPicture grey_picture(const io::GreyImage& image) {
  GreyPicture picture;
  picture.bytes = cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.bytes.data()));
  picture.values = image.values.empty()
                       ? picture.bytes
                       : cv::Mat(image.height, image.width, CV_32F, const_cast<float*>(image.values.data()));
  return picture;
}

Reduced reduced(const GreyPicture& picture, int longest_px) {
  Reduced result{picture.bytes, 1};
  const int longest = std::max(picture.bytes.cols, picture.bytes.rows);
  if (longest <= longest_px) return result;
  const int divisor = (longest + longest_px - 1) / longest_px;  // whole: every reduced pixel is the mean of a block
  const cv::Size size(picture.bytes.cols / divisor, picture.bytes.rows / divisor);
  const cv::Rect whole_blocks(0, 0, size.width * divisor, size.height * divisor);
  cv::resize(picture.bytes(whole_blocks), result.bytes, size, 0, 0, cv::INTER_AREA);
  result.scale = divisor;
  return result;
}

}  // namespace gonio::camera
