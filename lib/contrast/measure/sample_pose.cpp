// The sample's pose from marked corners and a robot's poses (contrast/measure/sample_pose.h).
#include "contrast/measure/sample_pose.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>

#include "base/error.h"
#include "linear/solve.h"

namespace gonio::contrast {
namespace {

using CameraFromPattern = Rigid<frame::Camera, frame::Object>;

// A small turn about the axes of `To` through `pivot`, and a shift.
template <class To, class From>
Rigid<To, From> moved(const Rigid<To, From>& pose, const double* step, Vec3 pivot) {
  const Quaternion turn = quaternion_of_rotation_vector({step[0], step[1], step[2]});
  const Vec3 shift{step[3], step[4], step[5]};
  return {normalized(turn * pose.rotation), matrix_of(turn) * (pose.translation_m - pivot) + pivot + shift};
}

Vec3 corner(const CellPattern& pattern, int k) {
  const Vec2 p = pattern.corner_m(k);
  return {p.x, p.y, 0};
}

Vec3 middle(const CellPattern& pattern) {
  const Vec2 size = pattern.size_m();
  return {size.x / 2, size.y / 2, 0};
}

// Both poses that the corners of one image allow (nothing where fewer than four are marked, or the camera is no central
// projection).
std::vector<CameraFromPattern> planar_poses(const CellPattern& pattern, const camera::CameraModel& camera,
                                            const std::vector<const PlacedMark*>& marks) {
  if (marks.size() < 4 || camera.orthographic()) return {};
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  const Vec3 about = middle(pattern);
  for (const PlacedMark* mark : marks) {
    const Vec3 p = corner(pattern, mark->corner) - about, ray = camera.ray(mark->pixel).direction;
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

struct Problem {
  const CellPattern& pattern;
  const std::vector<camera::CameraModel>& cameras;
  const std::vector<CameraPose>& poses;
  std::vector<PlacedMark> marks;
  std::vector<std::size_t> free;  // images whose pose may move: those with marks
  std::size_t size() const { return 6 + 6 * free.size(); }
  std::size_t rows() const { return 2 * marks.size() + 6 * free.size(); }
};

struct State {
  Rigid<frame::World, frame::Object> sample;
  std::vector<std::array<double, 6>> error;  // of the images in `free`
};

State stepped(const Problem& problem, const State& state, const Eigen::VectorXd& step) {
  State next = state;
  next.sample = moved(state.sample, step.data(), state.sample * middle(problem.pattern));
  for (std::size_t i = 0; i < next.error.size(); ++i)
    for (std::size_t k = 0; k < 6; ++k) next.error[i][k] += step(static_cast<Eigen::Index>(6 + 6 * i + k));
  return next;
}

std::optional<Vec2> predicted(const Problem& problem, const State& state, std::size_t slot, int k) {
  const std::size_t image = problem.free[slot];
  const auto seen = problem.poses[image].camera_from_world * state.sample;
  const auto with_error = moved(seen, state.error[slot].data(), {});
  return problem.cameras[image].project(with_error * corner(problem.pattern, k));
}

// Empty where a corner lies behind its camera.
Eigen::VectorXd residuals(const Problem& problem, const State& state) {
  Eigen::VectorXd r(static_cast<Eigen::Index>(problem.rows()));
  Eigen::Index row = 0;
  for (const PlacedMark& mark : problem.marks) {
    const auto slot = static_cast<std::size_t>(std::ranges::find(problem.free, mark.image) - problem.free.begin());
    const auto at = predicted(problem, state, slot, mark.corner);
    if (!at) return {};
    r(row++) = (at->x - mark.pixel.x) / mark.sigma_px;
    r(row++) = (at->y - mark.pixel.y) / mark.sigma_px;
  }
  for (std::size_t i = 0; i < problem.free.size(); ++i) {
    const CameraPose& pose = problem.poses[problem.free[i]];
    for (std::size_t k = 0; k < 6; ++k)
      r(row++) = state.error[i][k] / std::max(k < 3 ? pose.sigma_rad : pose.sigma_m, 1e-9);
  }
  return r;
}

Eigen::MatrixXd jacobian(const Problem& problem, const State& state) {
  const auto n = static_cast<Eigen::Index>(problem.size());
  Eigen::MatrixXd j(static_cast<Eigen::Index>(problem.rows()), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    constexpr double h = 1e-6;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
    step(k) = h;
    const Eigen::VectorXd up = residuals(problem, stepped(problem, state, step));
    const Eigen::VectorXd down = residuals(problem, stepped(problem, state, -step));
    j.col(k) = up.size() == j.rows() && down.size() == j.rows() ? Eigen::VectorXd((up - down) / (2 * h))
                                                                : Eigen::VectorXd::Zero(j.rows());
  }
  return j;
}

struct Solved {
  State state;
  double chi2 = 0;
  Eigen::MatrixXd normal;
  bool rests = false;
};

Solved solve(const Problem& problem, State state) {
  Solved solved{state, 0, {}, false};
  Eigen::VectorXd r = residuals(problem, state);
  if (r.size() == 0) return solved;
  double damping = 1e-4;
  for (int round = 0; round < 100 && !solved.rests; ++round) {
    const Eigen::MatrixXd j = jacobian(problem, solved.state);
    solved.normal = j.transpose() * j;
    const Eigen::VectorXd slope = j.transpose() * r;
    bool better = false;
    for (int attempt = 0; attempt < 12 && !better && !solved.rests; ++attempt, damping *= 10) {
      Eigen::MatrixXd damped = solved.normal;
      damped.diagonal() += damping * solved.normal.diagonal();
      const Eigen::VectorXd step = -linear::solve_ldlt(damped, slope);
      const State next = stepped(problem, solved.state, step);
      const Eigen::VectorXd after = residuals(problem, next);
      if (after.size() == 0 || !(after.squaredNorm() <= r.squaredNorm())) continue;
      solved.rests = r.squaredNorm() - after.squaredNorm() < 1e-9 * (1e-9 + r.squaredNorm());
      solved.state = next;
      r = after;
      better = true;
      damping = std::max(damping * 1e-3, 1e-12);
    }
    if (!better) break;
  }
  solved.rests = solved.rests || damping > 1e6;
  solved.chi2 = r.squaredNorm();
  return solved;
}

std::map<std::size_t, std::vector<const PlacedMark*>> by_image(const std::vector<PlacedMark>& marks) {
  std::map<std::size_t, std::vector<const PlacedMark*>> groups;
  for (const PlacedMark& mark : marks) groups[mark.image].push_back(&mark);
  return groups;
}

SamplePose pose_of(const Problem& problem, const Solved& solved) {
  SamplePose pose;
  pose.world_from_pattern = solved.state.sample;
  pose.chi2 = solved.chi2;
  pose.marks = static_cast<int>(problem.marks.size());
  pose.images = static_cast<int>(problem.free.size());
  pose.degrees = 2 * pose.marks - 6;
  const double widening = pose.degrees > 0 ? std::max(1.0, solved.chi2 / pose.degrees) : 1;
  const Eigen::MatrixXd covariance =
      linear::solve_ldlt(solved.normal, Eigen::MatrixXd::Identity(solved.normal.rows(), solved.normal.cols())) *
      widening;
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index k = 0; k < 6; ++k) pose.covariance[static_cast<std::size_t>(6 * i + k)] = covariance(i, k);
  const Eigen::VectorXd r = residuals(problem, solved.state);
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
  Problem problem{pattern, cameras, poses, marks, {}};
  std::vector<Rigid<frame::World, frame::Object>> starts;
  for (const auto& [image, of_image] : by_image(marks)) {
    problem.free.push_back(image);
    for (const CameraFromPattern& pose : planar_poses(pattern, cameras[image], of_image))
      starts.push_back(inverse(poses[image].camera_from_world) * pose);
  }
  if (starts.empty())
    throw Error(Exit::data, place, "has no image in which all four corners of the sample are marked",
                "mark the four corners, numbered 0 to 3 clockwise from the sample's top left, in one image at least");
  Solved best;
  for (const auto& start : starts) {
    const Solved solved = solve(problem, {start, std::vector<std::array<double, 6>>(problem.free.size())});
    if (solved.rests && (!best.rests || solved.chi2 < best.chi2)) best = solved;
  }
  if (!best.rests)
    throw Error(Exit::data, place, "has marked corners from which no pose of the sample follows",
                "check their order (clockwise from the sample's top left) and the size of the cells");
  return pose_of(problem, best);
}

CornerCovariance place_covariance(const CellPattern& pattern, const camera::CameraModel& camera, const CameraPose& pose,
                                  const SamplePose& sample) {
  const auto seen = pose.camera_from_world * sample.world_from_pattern;
  const Vec3 pivot = sample.world_from_pattern * middle(pattern);
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(sample.covariance.data());
  Eigen::Matrix<double, 8, 6> by_sample, by_camera;
  for (int k = 0; k < 4; ++k)
    for (int p = 0; p < 6; ++p) {
      constexpr double h = 1e-6;
      std::array<double, 6> up{}, down{};
      up[static_cast<std::size_t>(p)] = h;
      down[static_cast<std::size_t>(p)] = -h;
      const auto at = [&](const auto& camera_from_pattern) {
        return camera.project(camera_from_pattern * corner(pattern, k)).value_or(Vec2{});
      };
      const Vec2 s = at(pose.camera_from_world * moved(sample.world_from_pattern, up.data(), pivot)) -
                     at(pose.camera_from_world * moved(sample.world_from_pattern, down.data(), pivot));
      const Vec2 c = at(moved(seen, up.data(), {})) - at(moved(seen, down.data(), {}));
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
