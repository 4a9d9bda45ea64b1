// Where the adjustment begins: a pinhole from the homographies, poses from planes.
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "camera/bundle_adjustment.h"
#include "camera/camera_model.h"

namespace gonio::camera {
namespace {

constexpr double usual_focal = 1.2;  // of the longer side: a normal lens, where the homographies say nothing
constexpr double least_focal = 0.2, largest_focal = 50;
constexpr double fisheye_focal_low = 0.12, fisheye_focal_high = 3;  // of the longer side
constexpr double least_cosine = 0.1;  // of the angle from the axis, of corners that help to find a pose

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

// Sum of squared distances; corners that the lens does not show count as a picture's width away.
double misfit(const View& view, const Board& board, const Intrinsics& lens, const BoardPose& pose) {
  double sum = 0;
  for (const Corner& c : view.corners) {
    Vec2 pixel;
    if (!predict(lens, pose, board.extent(), {}, board.corner_m(c.id), pixel)) {
      sum += 1e6;
      continue;
    }
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

// A fisheye has no vanishing points to start from: the focal length, of a range, under which the planes fit best.
Intrinsics start_fisheye(const std::vector<View>& views, const Board& board, int width_px, int height_px) {
  const double longer = std::max(width_px, height_px);
  Intrinsics best;
  double least = HUGE_VAL;
  for (double share = fisheye_focal_low; share < fisheye_focal_high; share *= 1.15) {
    Intrinsics lens{share * longer, share * longer, 0.5 * (width_px - 1), 0.5 * (height_px - 1), {}};
    lens.distortion[LensTerm::fisheye] = 1;
    double sum = 0;
    for (const View& view : views) sum += std::sqrt(misfit(view, board, lens, start_pose(view, board, lens)));
    if (sum >= least) continue;
    least = sum;
    best = lens;
  }
  return best;
}

}  // namespace

Intrinsics start_lens(const std::vector<View>& views, const Board& board, const std::string& model, int width_px,
                      int height_px) {
  if (camera_model_info(model, "calibration").fisheye > 0) return start_fisheye(views, board, width_px, height_px);
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
  // Every corner as seen by a perspective camera of focal length one; what lies too far aside has no place there.
  const CameraModel camera(lens, 1, 1);
  std::vector<cv::Point3f> points;
  std::vector<cv::Point2f> plane;
  const std::vector<cv::Point3f> all = board_points(view, board);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Vec3 d = camera.ray(view.corners[i].pixel).direction;
    if (!(d.z > least_cosine)) continue;
    points.push_back(all[i]);
    plane.emplace_back(static_cast<float>(d.x / d.z), static_cast<float>(d.y / d.z));
  }
  BoardPose best{{}, {0, 0, 1}};
  if (points.size() < 4) return best;
  std::vector<cv::Mat> rotations, translations;
  cv::solvePnPGeneric(points, plane, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                      cv::SOLVEPNP_IPPE);
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
