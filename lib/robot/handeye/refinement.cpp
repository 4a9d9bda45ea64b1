#include "robot/handeye/refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "robot/handeye/pose_adjustment.h"
#include "stats/distributions.h"

namespace gonio::robot::handeye {
namespace {

constexpr int most_rounds = 6;
constexpr double least_factor = 1e-6;  // of corner noise: exact corners, as tests have them

using RowMajor12 = Eigen::Matrix<double, 12, 12, Eigen::RowMajor>;

// How much the corners scatter beyond sigma_px, from poses fitted to every view alone: 2 corners - 6 degrees of freedom
// each.
double corner_factor(const Setup& setup, const std::vector<View>& views, const std::vector<bool>& counts) {
  double factor = 1;
  for (int round = 0; round < 5; ++round) {
    double squares = 0, freedom = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!counts[i]) continue;
      const CornerInformation c = corner_information(setup, views[i], views[i].camera_from_board, factor);
      squares += c.squares;
      freedom += c.coordinates - 6;
    }
    if (freedom < 1) return factor;
    factor = std::max(least_factor, std::sqrt(squares / freedom));
  }
  return factor;
}

// The pose and covariance that stand for the corners around the pose `at`.
ObservedPose observed_pose(const Setup& setup, const View& view, const camera::BoardPose& at, double factor,
                           bool counts) {
  const CornerInformation c = corner_information(setup, view, at, factor);
  const auto solver = c.information.ldlt();
  const Vector6 change = -solver.solve(c.gradient);
  const Matrix6 inverse = solver.solve(Matrix6::Identity());
  return {view.base_from_tool, moved_by(at, change), 0.5 * factor * factor * (inverse + inverse.transpose()), counts,
          setup.middle_m()};
}

// Best estimate of the board's pose in a view, given both what the camera saw and what the robot said.
camera::BoardPose joint_pose(Kind kind, const ObservedPose& o, const Solution& s, const Noise& noise) {
  const Deviation d = deviation(kind, o, s);
  const Vector6 change =
      -o.covariance * d.by_pose.transpose() * linear::solve_ldlt(deviation_covariance(d, o, noise), d.value);
  return moved_by(o.camera_from_board, change);
}

// Covariance that the lens's brings: views see their board at T - C^-1 C_lens dk for a change dk of the lens.
Matrix12 spread_of_lens(const Setup& setup, const std::vector<View>& views, const std::vector<ObservedPose>& observed,
                        const Refined& result, const Matrix12& covariance) {
  const auto k = static_cast<Eigen::Index>(setup.lens_order.size());
  if (k == 0 || setup.lens_covariance.size() != static_cast<std::size_t>(k * k)) return Matrix12::Zero();
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(12, k);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!observed[i].counts) continue;
    const CornerInformation c = corner_information(setup, views[i], observed[i].camera_from_board, result.noise.corner);
    const Deviation d = deviation(setup.kind, observed[i], result.solution);
    const Matrix6x12 weighted = linear::solve_ldlt(deviation_covariance(d, observed[i], result.noise), d.by_mountings);
    slope.noalias() += weighted.transpose() * d.by_pose * -linear::solve_ldlt(c.information, c.lens);
  }
  const Eigen::Map<const Eigen::MatrixXd> lens(setup.lens_covariance.data(), k, k);
  const Eigen::MatrixXd change = -covariance * slope;
  return change * lens * change.transpose();
}

void enter_covariance(const Setup& setup, const std::vector<View>& views, const std::vector<ObservedPose>& observed,
                      Refined& result) {
  const Matrix12 n = information(setup.kind, observed, result.solution, result.noise);
  const Vector12 scale = n.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Matrix12 scaled = scale.asDiagonal() * n * scale.asDiagonal();
  const Matrix12 inverse =
      scale.asDiagonal() * Matrix12(linear::solve_ldlt(scaled, Matrix12::Identity())) * scale.asDiagonal();
  const auto used = std::ranges::count_if(observed, [](const ObservedPose& o) { return o.counts; });
  const double freedom = 3.0 * static_cast<double>(used) - 6;
  const double widening = stats::student_quantile(0.975, std::max(1.0, freedom)) / stats::normal_quantile(0.975);
  const Matrix12 lens = spread_of_lens(setup, views, observed, result, inverse);
  const Matrix12 all = 0.5 * widening * widening * (inverse + inverse.transpose()) + lens;
  Eigen::Map<RowMajor12>(result.information.data()) = n;
  Eigen::Map<RowMajor12>(result.covariance.data()) = all;
  Eigen::Map<RowMajor12>(result.from_lens.data()) = lens;
}

}  // namespace

double Refined::sigma(std::size_t parameter) const {
  return std::sqrt(std::max(0.0, covariance[13 * parameter]));
}

Refined refine(const Setup& setup, const std::vector<View>& views, const std::vector<bool>& counts,
               const Solution& start) {
  Refined result;
  result.solution = start;
  result.noise.corner = corner_factor(setup, views, counts);
  for (const View& view : views) result.camera_from_board.push_back(view.camera_from_board);
  std::vector<ObservedPose> observed(views.size());
  for (int round = 0; round < most_rounds; ++round) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      observed[i] = observed_pose(setup, views[i], result.camera_from_board[i], result.noise.corner, counts[i]);
    }
    const PoseAdjustment adjusted = adjust_poses(setup.kind, observed, result.solution, result.noise);
    result.solution = adjusted.solution;
    result.noise = adjusted.noise;
    result.converged = adjusted.converged;
    double largest = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const camera::BoardPose pose = joint_pose(setup.kind, observed[i], result.solution, result.noise);
      const camera::BoardPose& old = result.camera_from_board[i];
      Vector6 change;
      change << eigen_of(rotation_vector_of(pose.rotation * conjugate(old.rotation))),
          eigen_of(pose.translation_m - old.translation_m);
      if (counts[i]) largest = std::max(largest, std::sqrt(change.dot(linear::solve_ldlt(observed[i].covariance, change))));
      result.camera_from_board[i] = pose;
    }
    if (largest < 1e-3) break;
  }
  for (const ObservedPose& o : observed) {
    const Deviation d = deviation(setup.kind, o, result.solution);
    const double distance2 = d.value.dot(linear::solve_ldlt(deviation_covariance(d, o, result.noise), d.value));
    result.mismatches.push_back({vec_of(d.value.tail<3>()), vec_of(d.value.head<3>()), distance2});
  }
  enter_covariance(setup, views, observed, result);
  return result;
}

}  // namespace gonio::robot::handeye
