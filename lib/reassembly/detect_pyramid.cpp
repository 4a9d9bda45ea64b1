// Pictures at all sizes, their noise, and how a cone lies in them.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "reassembly/detect_parts.h"
#include "stats/intervals.h"

namespace gonio::reassembly {

namespace {

// J. Immerkaer, "Fast noise variance estimation", CVIU 64(2), 1996: a mask that is blind to anything linear; its
// response to white noise of deviation 1 has deviation 6. The quieter blocks tell: texture only adds to it.
double noise_of(const cv::Mat& values) {
  constexpr int block = 24, least = 8;
  const cv::Mat mask = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  std::vector<double> sigmas, response;
  const int stride = std::max(block, static_cast<int>(std::sqrt(double(values.rows) * values.cols / 4000.0)));
  for (int y = 0; y + least < values.rows; y += stride)
    for (int x = 0; x + least < values.cols; x += stride) {
      const cv::Rect place(x, y, std::min(block, values.cols - x), std::min(block, values.rows - y));
      cv::Mat part, high;
      values(place).convertTo(part, CV_32F);
      double darkest = 0, brightest = 0;
      cv::minMaxLoc(part, &darkest, &brightest);
      if (brightest > 254.5 || darkest == brightest) continue;  // clipped noise is not noise
      cv::filter2D(part, high, CV_32F, mask);
      response.clear();
      for (int i = 1; i + 1 < high.rows; ++i)
        for (int j = 1; j + 1 < high.cols; ++j) response.push_back(std::abs(double(high.at<float>(i, j))));
      sigmas.push_back(stats::sigma_of_median * stats::median(response) / 6);
    }
  constexpr double rounding = 0.29;  // of a byte: 1 / sqrt(12)
  return sigmas.empty() ? rounding : std::max(rounding, stats::quantile(sigmas, 0.2));
}

}  // namespace

Cone moved(const Cone& cone, double across_rad, double down_rad, double half_angle_rad) {
  const ConeFrame frame(cone.axis);
  return {normalized(frame.axis + frame.across * across_rad + frame.down * down_rad),
          cone.half_angle_rad + half_angle_rad};
}

Pyramid pyramid_of(const io::GreyImage& picture, const std::vector<unsigned char>& mask, double largest_px) {
  Pyramid pyramid;
  const cv::Mat bytes(picture.height, picture.width, CV_8U, const_cast<std::uint8_t*>(picture.bytes.data()));
  pyramid.values = picture.values.empty()
                       ? bytes
                       : cv::Mat(picture.height, picture.width, CV_32F, const_cast<float*>(picture.values.data()));
  if (!mask.empty())
    pyramid.usable = cv::Mat(picture.height, picture.width, CV_8U, const_cast<unsigned char*>(mask.data())) != 0;
  pyramid.noise = noise_of(pyramid.values);
  pyramid.levels.push_back({bytes, pyramid.usable, 1});
  constexpr int smallest_side = 16;
  constexpr double radius_at_level = 6;
  while (true) {
    const PictureLevel& last = pyramid.levels.back();
    const cv::Size size(last.bytes.cols / 2, last.bytes.rows / 2);
    if (std::min(size.width, size.height) < smallest_side || 2 * last.scale * radius_at_level > largest_px) break;
    PictureLevel next;
    next.scale = 2 * last.scale;
    const cv::Rect whole(0, 0, 2 * size.width, 2 * size.height);
    cv::resize(last.bytes(whole), next.bytes, size, 0, 0, cv::INTER_AREA);
    if (!last.usable.empty()) {
      cv::resize(last.usable(whole), next.usable, size, 0, 0, cv::INTER_AREA);
      next.usable = next.usable == 255;
    }
    pyramid.levels.push_back(next);
  }
  return pyramid;
}

std::optional<OutlinePoint> outline_point(const camera::CameraModel& camera, const ConeFrame& frame, double half_angle,
                                          double turn) {
  const double step = 0.02 * half_angle + 1e-7;
  const auto at = camera.project(frame.ray(turn, half_angle));
  const auto out = camera.project(frame.ray(turn, half_angle + step));
  const auto in = camera.project(frame.ray(turn, half_angle - step));
  const auto after = camera.project(frame.ray(turn + 0.02, half_angle));
  const auto before = camera.project(frame.ray(turn - 0.02, half_angle));
  if (!at || !out || !in || !after || !before) return std::nullopt;
  const Vec2 along = *after - *before, radial = *out - *in;
  const double length = norm(along);
  if (!(length > 0)) return std::nullopt;
  OutlinePoint point;
  point.pixel = *at;
  point.normal = {along.y / length, -along.x / length};
  const double outwards = dot(radial, point.normal);
  if (outwards < 0) point.normal = point.normal * -1;
  point.px_per_rad = std::abs(outwards) / (2 * step);
  return point.px_per_rad > 0 ? std::optional(point) : std::nullopt;
}

double outline_radius_px(const camera::CameraModel& camera, const Cone& cone) {
  const ConeFrame frame(cone.axis);
  const auto centre = camera.project(cone.axis);
  if (!centre) return 0;
  constexpr int turns = 16;
  double sum = 0;
  for (int i = 0; i < turns; ++i) {
    const auto point = camera.project(frame.ray(2 * pi * i / turns, cone.half_angle_rad));
    if (!point) return 0;
    sum += norm(*point - *centre);
  }
  return sum / turns;
}

}  // namespace gonio::reassembly
