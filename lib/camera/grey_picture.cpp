// Pictures to grey, and saddle-point refinement with a window that follows the size of the squares.
#include "camera/grey_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace gonio::camera {
namespace {

constexpr int least_window_px = 2, largest_window_px = 15;
constexpr double largest_move = 0.25;  // of a square

float white_level(const cv::Mat& values) {
  double low = 0, high = 0;
  cv::minMaxLoc(values, &low, &high);
  if (high <= 1) return 1;
  std::vector<float> sorted(values.begin<float>(), values.end<float>());
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at > 0 ? *at : static_cast<float>(high);
}

}  // namespace

GreyPicture grey_picture(const io::Image& image) {
  const int r = image.channel("R"), g = image.channel("G"), b = image.channel("B");
  const bool colour = r >= 0 && g >= 0 && b >= 0;
  GreyPicture picture;
  picture.values.create(image.height, image.width, CV_32F);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float v = colour ? 0.299F * image.at(x, y, r) + 0.587F * image.at(x, y, g) + 0.114F * image.at(x, y, b)
                             : image.at(x, y, 0);
      picture.values.at<float>(y, x) = std::isfinite(v) ? std::max(v, 0.0F) : 0.0F;
    }
  }
  picture.values = cv::min(picture.values * (255.0 / white_level(picture.values)), 255.0);
  picture.values.convertTo(picture.bytes, CV_8U);
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

std::vector<Corner> refine(const GreyPicture& picture, const std::vector<Prediction>& predictions, double window_share,
                           const DetectionOptions& options) {
  std::vector<Corner> corners;
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-4);
  for (const Prediction& prediction : predictions) {
    const int window = options.window_px > 0
                           ? options.window_px
                           : std::clamp(static_cast<int>(std::lround(window_share * prediction.square_px)),
                                        least_window_px, largest_window_px);
    const double margin = window + 2;
    if (prediction.pixel.x < margin || prediction.pixel.y < margin ||
        prediction.pixel.x > picture.values.cols - 1 - margin ||
        prediction.pixel.y > picture.values.rows - 1 - margin) {
      continue;
    }
    std::vector<cv::Point2f> point{cv::Point2f(prediction.pixel)};
    cv::cornerSubPix(picture.values, point, cv::Size(window, window), cv::Size(-1, -1), until);
    const cv::Point2d moved = cv::Point2d(point[0]) - prediction.pixel;
    if (!(std::hypot(moved.x, moved.y) <= largest_move * prediction.square_px)) continue;
    corners.push_back({prediction.id, {point[0].x, point[0].y}});
  }
  std::ranges::sort(corners, {}, &Corner::id);
  return corners;
}

}  // namespace gonio::camera
