#include "robot/handeye/pose_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "linear/symmetric_eigen.h"

namespace gonio::robot::handeye {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double least_m = 1e-9, least_rad = 1e-9;
constexpr double board_turn_share = 0.3;  // of the robot's turn, to begin with
constexpr int most_updates = 400;

// Symmetric inverse under unit diagonal; directions without information are left out.
Eigen::MatrixXd inverse_of_information(const Eigen::MatrixXd& n, double least) {
  const Eigen::VectorXd scale = n.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const linear::SymmetricEigen<Eigen::MatrixXd> e(scale.asDiagonal() * n * scale.asDiagonal());
  const Eigen::VectorXd inverse = e.eigenvalues().unaryExpr([least](double v) { return v > least ? 1 / v : 0.0; });
  const Eigen::MatrixXd root = scale.asDiagonal() * e.eigenvectors();
  return root * inverse.asDiagonal() * root.transpose();
}

}  // namespace

Matrix6 NoisyPose::covariance(const Noise& noise) const {
  return measured + noise.robot_rad * noise.robot_rad * by_turn * by_turn.transpose() +
         noise.robot_m * noise.robot_m * by_shift * by_shift.transpose() +
         noise.board_rad * noise.board_rad * by_board * by_board.transpose();
}

// At a fixed linearisation: v <- v (y' G G' y) / trace(G' P G), y = P e, with G the columns through which each acts.
NoiseStep update_noise(const std::vector<NoisyPose>& poses, const Eigen::VectorXd& prior_precision, Noise& noise,
                       double least_information) {
  if (poses.empty()) return {};
  const Eigen::Index n = poses[0].jacobian.cols();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  if (prior_precision.size() == n) information.diagonal() = prior_precision;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
  for (const NoisyPose& pose : poses) {
    const Eigen::MatrixXd weighted = linear::solve_ldlt(pose.covariance(noise), pose.jacobian);
    information.noalias() += pose.jacobian.transpose() * weighted;
    gradient.noalias() += weighted.transpose() * pose.residual;
  }
  NoiseStep step{{}, inverse_of_information(information, least_information), 0};
  step.change = -step.covariance * gradient;
  std::array<double, 3> squares{}, trace{};
  for (const NoisyPose& pose : poses) {
    const auto solver = pose.covariance(noise).ldlt();
    const Vector6 y = solver.solve(pose.residual + pose.jacobian * step.change);
    const Eigen::MatrixXd weighted = solver.solve(pose.jacobian);
    const Matrix6 p = Matrix6(solver.solve(Matrix6::Identity())) - weighted * step.covariance * weighted.transpose();
    const std::array<const NoisyPose::Effect*, 3> by = {&pose.by_turn, &pose.by_shift, &pose.by_board};
    for (std::size_t k = 0; k < 3; ++k) {
      squares[k] += (by[k]->transpose() * y).squaredNorm();
      trace[k] += (by[k]->transpose() * p * *by[k]).trace();
    }
  }
  const auto updated = [&](double sigma, std::size_t k, double least) {
    if (!(trace[k] > 0)) return sigma;
    return std::max(least, sigma * std::sqrt(std::clamp(squares[k] / trace[k], 1e-2, 1e2)));
  };
  const Noise before = noise;
  noise.robot_rad = updated(noise.robot_rad, 0, least_rad);
  noise.robot_m = updated(noise.robot_m, 1, least_m);
  noise.board_rad = updated(noise.board_rad, 2, least_rad);
  // A variance on its way to zero takes long and matters little: changes count by their share of what they join.
  const double board_share = std::min(1.0, noise.board_rad / noise.robot_rad);
  step.moved = std::max({std::abs(std::log(noise.robot_rad / before.robot_rad)),
                         std::abs(std::log(noise.robot_m / before.robot_m)),
                         board_share * board_share * std::abs(std::log(noise.board_rad / before.board_rad))});
  return step;
}

void begin_noise(const std::vector<NoisyPose>& poses, Noise& noise) {
  if (noise.robot_m > 0 && noise.robot_rad > 0) return;
  double turn = 0, shift = 0;
  for (const NoisyPose& pose : poses) {
    Matrix6 by;
    by << pose.by_turn, pose.by_shift;
    const Vector6 tool = by.fullPivLu().solve(pose.residual);
    turn += tool.head<3>().squaredNorm();
    shift += tool.tail<3>().squaredNorm();
  }
  const double coordinates = 3 * std::max<double>(1, static_cast<double>(poses.size()));
  noise.robot_rad = std::max(least_rad, std::sqrt(turn / coordinates));
  noise.robot_m = std::max(least_m, std::sqrt(shift / coordinates));
  noise.board_rad = board_turn_share * noise.robot_rad;
}

NoiseStep estimate_noise(const std::vector<NoisyPose>& poses, const Eigen::VectorXd& prior_precision, Noise& noise,
                         double least_information) {
  begin_noise(poses, noise);
  NoiseStep step;
  for (int k = 0; k < most_updates; ++k) {
    step = update_noise(poses, prior_precision, noise, least_information);
    if (step.moved < 1e-7) break;
  }
  return step;
}

}  // namespace gonio::robot::handeye
