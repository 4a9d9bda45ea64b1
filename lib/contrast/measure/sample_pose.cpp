// The sample's pose from marked corners and a robot's poses (contrast/measure/sample_pose.h).
#include "contrast/measure/sample_pose.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <optional>

#include "base/error.h"
#include "contrast/measure/sample_pose_problem.h"
#include "optim/ceres_fit.h"

namespace gonio::contrast {
namespace {

using CameraFromPattern = Rigid<frame::Camera, frame::Object>;

// Both poses that the corners of one image allow (nothing where fewer than four are marked, or the camera is no central
// projection).
std::vector<CameraFromPattern> planar_poses(const CellPattern& pattern, const camera::CameraModel& camera,
                                            const std::vector<const PlacedMark*>& marks) {
  if (marks.size() < 4 || camera.orthographic()) return {};
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  const Vec3 about = pattern_middle(pattern);
  for (const PlacedMark* mark : marks) {
    const Vec3 p = pattern_corner(pattern, mark->corner) - about, ray = camera.ray(mark->pixel).direction;
    if (!(ray.z > 1e-6)) return {};
    object.emplace_back(p.x, p.y, 0.0);
    image.emplace_back(ray.x / ray.z, ray.y / ray.z);
  }
  std::vector<cv::Mat> turns, shifts;
  cv::solvePnPGeneric(object, image, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turns, shifts, false,
                      cv::SOLVEPNP_IPPE);
  std::vector<CameraFromPattern> poses;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Vec3 turn{turns[i].at<double>(0), turns[i].at<double>(1), turns[i].at<double>(2)};
    CameraFromPattern pose{quaternion_of_rotation_vector(turn), {}};
    pose.translation_m =
        Vec3{shifts[i].at<double>(0), shifts[i].at<double>(1), shifts[i].at<double>(2)} - pose.rotate(about);
    if (std::isfinite(norm(pose.translation_m))) poses.push_back(pose);
  }
  return poses;
}

// Nothing where a corner lies behind its camera at the start, or the fit does not come to rest.
std::optional<optim::Fit> solve(const SamplePoseProblem& problem, const SamplePoseProblem::Pose& start) {
  const Eigen::VectorXd x = problem.parameters(start);
  Eigen::VectorXd r;
  if (!problem.residuals(x, r)) return {};
  optim::Limits limits;
  limits.first_damping = 1e-4;
  limits.small_fall = {1e-9, 0};
  optim::Fit found = optim::fit_by_ceres(problem, x, limits);
  if (!found.descended.settled()) return {};
  return found;
}

std::map<std::size_t, std::vector<const PlacedMark*>> by_image(const std::vector<PlacedMark>& marks) {
  std::map<std::size_t, std::vector<const PlacedMark*>> groups;
  for (const PlacedMark& mark : marks) groups[mark.image].push_back(&mark);
  return groups;
}

SamplePose pose_of(const SamplePoseProblem& problem, const optim::Fit& solved) {
  SamplePose pose;
  pose.world_from_pattern = SamplePoseProblem::pose(solved.x);
  pose.chi2 = solved.cost;
  pose.marks = static_cast<int>(problem.marks.size());
  pose.images = static_cast<int>(problem.free.size());
  pose.degrees = 2 * pose.marks - 6;
  const double widening = pose.degrees > 0 ? std::max(1.0, pose.chi2 / pose.degrees) : 1;
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index k = 0; k < 6; ++k)
      pose.covariance[static_cast<std::size_t>(6 * i + k)] = solved.covariance(i, k) * widening;
  Eigen::VectorXd r;
  problem.residuals(solved.x, r);
  double sum = 0;
  for (std::size_t i = 0; i < problem.marks.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const double d = r(static_cast<Eigen::Index>(2 * i + k)) * problem.marks[i].sigma_px;
      sum += d * d;
    }
  pose.rms_px = std::sqrt(sum / static_cast<double>(problem.marks.size()));
  return pose;
}

}  // namespace

SamplePose locate_sample(const CellPattern& pattern, const std::vector<camera::CameraModel>& cameras,
                         const std::vector<CameraPose>& poses, const std::vector<PlacedMark>& marks,
                         const std::string& place) {
  const SamplePoseProblem problem(pattern, cameras, poses, marks);
  std::vector<SamplePoseProblem::Pose> starts;
  for (const auto& [image, of_image] : by_image(marks))
    for (const CameraFromPattern& pose : planar_poses(pattern, cameras[image], of_image))
      starts.push_back(inverse(poses[image].camera_from_world) * pose);
  if (starts.empty())
    throw Error(Exit::data, place, "has no image in which all four corners of the sample are marked",
                "mark the four corners, numbered 0 to 3 clockwise from the sample's top left, in one image at least");
  std::optional<optim::Fit> best;
  for (const SamplePoseProblem::Pose& start : starts) {
    auto solved = solve(problem, start);
    if (solved && (!best || solved->cost < best->cost)) best = std::move(solved);
  }
  if (!best)
    throw Error(Exit::data, place, "has marked corners from which no pose of the sample follows",
                "check their order (clockwise from the sample's top left) and the size of the cells");
  return pose_of(problem, *best);
}

CornerCovariance place_covariance(const CellPattern& pattern, const camera::CameraModel& camera, const CameraPose& pose,
                                  const SamplePose& sample) {
  const auto seen = pose.camera_from_world * sample.world_from_pattern;
  const Vec3 pivot = sample.world_from_pattern * pattern_middle(pattern);
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(sample.covariance.data());
  Eigen::Matrix<double, 8, 6> by_sample, by_camera;
  for (int k = 0; k < 4; ++k)
    for (int p = 0; p < 6; ++p) {
      constexpr double h = 1e-6;
      std::array<double, 6> up{}, down{};
      up[static_cast<std::size_t>(p)] = h;
      down[static_cast<std::size_t>(p)] = -h;
      const auto at = [&](const auto& camera_from_pattern) {
        return camera.project(camera_from_pattern * pattern_corner(pattern, k)).value_or(Vec2{});
      };
      const Vec2 s = at(pose.camera_from_world * turned_about(sample.world_from_pattern, up.data(), pivot)) -
                     at(pose.camera_from_world * turned_about(sample.world_from_pattern, down.data(), pivot));
      const Vec2 c = at(turned_about(seen, up.data(), {})) - at(turned_about(seen, down.data(), {}));
      by_sample.block<2, 1>(2 * k, p) << s.x / (2 * h), s.y / (2 * h);
      by_camera.block<2, 1>(2 * k, p) << c.x / (2 * h), c.y / (2 * h);
    }
  Eigen::Matrix<double, 6, 1> robot;
  robot << Eigen::Vector3d::Constant(pose.sigma_rad * pose.sigma_rad),
      Eigen::Vector3d::Constant(pose.sigma_m * pose.sigma_m);
  CornerCovariance place{};
  Eigen::Map<Eigen::Matrix<double, 8, 8, Eigen::RowMajor>>(place.data()) =
      by_sample * covariance * by_sample.transpose() + by_camera * robot.asDiagonal() * by_camera.transpose();
  return place;
}

}  // namespace gonio::contrast
