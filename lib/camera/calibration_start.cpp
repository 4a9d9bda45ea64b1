// Where the adjustment begins: a pinhole from the homographies, poses from planes.
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "camera/bundle_adjustment.h"

namespace gonio::camera {
namespace {

constexpr double usual_focal = 1.2;  // of the longer side: a normal lens, where the homographies say nothing
constexpr double least_focal = 0.2, largest_focal = 50;

cv::Matx33d matrix_of(const Intrinsics& lens) {
  return {lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1};
}

std::vector<cv::Point3f> board_points(const View& view, const Board& board) {
  std::vector<cv::Point3f> points;
  for (const Corner& c : view.corners) {
    const Vec2 at = board.corner_m(c.id);
    points.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y), 0.0F);
  }
  return points;
}

std::vector<cv::Point2f> pixels(const View& view) {
  std::vector<cv::Point2f> points;
  for (const Corner& c : view.corners)
    points.emplace_back(static_cast<float>(c.pixel.x), static_cast<float>(c.pixel.y));
  return points;
}

double misfit(const View& view, const Board& board, const Intrinsics& lens, const BoardPose& pose) {
  double sum = 0;
  for (const Corner& c : view.corners) {
    Vec2 pixel;
    if (!predict(lens, pose, board.extent(), {}, board.corner_m(c.id), pixel)) return HUGE_VAL;
    sum += dot(pixel - c.pixel, pixel - c.pixel);
  }
  return sum;
}

BoardPose pose_of(const cv::Mat& rotation, const cv::Mat& translation) {
  cv::Matx33d r;
  cv::Rodrigues(rotation, r);
  Mat3 m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) = r(i, j);
  }
  return {quaternion_of(m), {translation.at<double>(0), translation.at<double>(1), translation.at<double>(2)}};
}

}  // namespace

Intrinsics start_lens(const std::vector<View>& views, const Board& board, int width_px, int height_px) {
  std::vector<std::vector<cv::Point3f>> objects;
  std::vector<std::vector<cv::Point2f>> images;
  for (const View& view : views) {
    objects.push_back(board_points(view, board));
    images.push_back(pixels(view));
  }
  const cv::Mat k = cv::initCameraMatrix2D(objects, images, cv::Size(width_px, height_px), 0);
  const double longer = std::max(width_px, height_px);
  const auto plausible = [&](double f) { return f > least_focal * longer && f < largest_focal * longer; };
  double fx = k.at<double>(0, 0), fy = k.at<double>(1, 1);
  if (!plausible(fx)) fx = fy;
  if (!plausible(fy)) fy = fx;
  if (!plausible(fx) || fx / fy > 2 || fy / fx > 2) fx = fy = usual_focal * longer;
  return {fx, fy, 0.5 * (width_px - 1), 0.5 * (height_px - 1), {}};
}

BoardPose start_pose(const View& view, const Board& board, const Intrinsics& lens) {
  const std::vector<double> distortion{
      lens.distortion[0], lens.distortion[1], lens.distortion[2], lens.distortion[3], lens.distortion[4], 0, 0, 0,
      lens.distortion[5], lens.distortion[6], lens.distortion[7], lens.distortion[8]};
  std::vector<cv::Mat> rotations, translations;
  cv::solvePnPGeneric(board_points(view, board), pixels(view), matrix_of(lens), distortion, rotations, translations,
                      false, cv::SOLVEPNP_IPPE);
  BoardPose best{{}, {0, 0, 1}};
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const BoardPose pose = pose_of(rotations[i], translations[i]);
    const double error = misfit(view, board, lens, pose);
    if (error >= least) continue;
    least = error;
    best = pose;
  }
  return best;
}

}  // namespace gonio::camera
