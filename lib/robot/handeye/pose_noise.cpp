// See pose_noise.h. Sums over views keep it linear in their number: with V the covariance of all residuals, W = V^-1
// and C = (J'WJ + prior)^-1, the matrix P = W - W J C J' W enters only through traces and through y = P residual.
#include "robot/handeye/pose_noise.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "linear/symmetric_eigen.h"

namespace gonio::robot::handeye {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Effects = Eigen::Matrix<double, 6, 9>;  // turn, shift, board
using Jacobian = Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic>>;

// No controller states its poses more finely, and exact recordings would be weighed by the rounding of corners alone.
constexpr double least_m = 1e-7, least_rad = 1e-7;
constexpr double board_turn_share = 0.3;                 // of the robot's turn, to begin with
constexpr double least_information = 1e-12;              // of columns of unit length
constexpr double farthest_down = 0.1, farthest_up = 10;  // of a variance, in one step
constexpr int most_updates = 200;

Matrix6 covariance_of(const PoseScatter& s, const Noise& noise) {
  using MapEffect = Eigen::Map<const Eigen::Matrix<double, 6, 3>>;
  const MapEffect turn(s.by_turn.data()), shift(s.by_shift.data()), board(s.by_board.data());
  return Eigen::Map<const Matrix6>(s.measured.data()) + noise.robot_rad * noise.robot_rad * turn * turn.transpose() +
         noise.robot_m * noise.robot_m * shift * shift.transpose() +
         noise.board_rad * noise.board_rad * board * board.transpose();
}

Jacobian jacobian_of(const NoisyPose& pose) {
  return {pose.jacobian.data(), 6, static_cast<Eigen::Index>(pose.jacobian.size() / 6)};
}

Effects effects_of(const PoseScatter& s) {
  Effects all;
  std::ranges::copy(s.by_turn, all.data());
  std::ranges::copy(s.by_shift, all.data() + 18);
  std::ranges::copy(s.by_board, all.data() + 36);
  return all;
}

bool acts(const std::vector<NoisyPose>& poses, PoseScatter::Effect PoseScatter::*effect) {
  return std::ranges::any_of(poses, [&](const NoisyPose& pose) {
    return std::ranges::any_of(pose.scatter.*effect, [](double v) { return v != 0; });
  });
}

// (data + prior)^-1, columns of the data scaled to unit length, on the directions of which the data say something:
// along the others a prior alone would decide how parameters that imitate each other share what one of them has.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& data, const Eigen::VectorXd& prior) {
  const Eigen::VectorXd scale = data.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
  const linear::SymmetricEigen<Eigen::MatrixXd> e(scale.asDiagonal() * data * scale.asDiagonal());
  const Eigen::Index told = (e.eigenvalues().array() > least_information).count();  // the last: they ascend
  if (told == 0) return Eigen::MatrixXd::Zero(data.rows(), data.cols());
  const Eigen::MatrixXd kept = scale.asDiagonal() * e.eigenvectors().rightCols(told);
  Eigen::MatrixXd information = kept.transpose() * prior.asDiagonal() * kept;
  information.diagonal() += e.eigenvalues().tail(told);
  return kept * linear::solve_ldlt(information, Eigen::MatrixXd(kept.transpose()));
}

struct Fit {
  Eigen::VectorXd change;
  Eigen::MatrixXd information, covariance;
};
Fit fit(const std::vector<NoisyPose>& poses, const Noise& noise, Precision prior_precision) {
  const Eigen::Index n = poses.empty() ? 0 : jacobian_of(poses[0]).cols();
  Fit f{{}, Eigen::MatrixXd::Zero(n, n), {}};
  if (n == 0) return f;
  Eigen::VectorXd prior = Eigen::VectorXd::Zero(n), gradient = prior;
  std::ranges::copy(prior_precision, prior.begin());
  for (const NoisyPose& pose : poses) {
    const Jacobian j = jacobian_of(pose);
    const Eigen::Matrix<double, 6, Eigen::Dynamic> weighted = linear::solve_ldlt(covariance_of(pose.scatter, noise), j);
    f.information.noalias() += j.transpose() * weighted;
    gradient.noalias() += weighted.transpose() * Eigen::Map<const Vector6>(pose.residual.data());
  }
  f.covariance = inverse_of(f.information, prior);
  f.information.diagonal() += prior;
  f.change = -f.covariance * gradient;
  return f;
}

// Derivatives of the restricted likelihood's logarithm by the variances of turn, shift and board, and their average
// information.
struct Score {
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};
// With G the effects of a component, U = G' W J, M_ab = G_a' W G_b, and z = G' y:
//   2 slope_a        = sum |z_a|^2 - tr(M_aa - U_a C U_a')
//   2 information_ab = sum z_a' M_ab z_b - t_a' C t_b,  t_a = sum U_a' z_a.
Score score(const std::vector<NoisyPose>& poses, const Noise& noise, const Fit& f) {
  Score s;
  Eigen::MatrixXd shared = Eigen::MatrixXd::Zero(f.change.size(), 3);
  for (const NoisyPose& pose : poses) {
    const Jacobian j = jacobian_of(pose);
    const Effects g = effects_of(pose.scatter);
    const Effects weighted = linear::solve_ldlt(covariance_of(pose.scatter, noise), Matrix6::Identity()) * g;
    const Eigen::Matrix<double, 9, Eigen::Dynamic> u = weighted.transpose() * j;
    const Matrix9 m = g.transpose() * weighted, p = m - u * f.covariance * u.transpose();
    const Vector6 left = Eigen::Map<const Vector6>(pose.residual.data()) + j * f.change;
    const Eigen::Matrix<double, 9, 1> z = weighted.transpose() * left;
    for (Eigen::Index a = 0; a < 3; ++a) {
      const auto za = z.segment<3>(3 * a);
      s.slope[a] += 0.5 * (za.squaredNorm() - p.block<3, 3>(3 * a, 3 * a).trace());
      shared.col(a) += u.middleRows<3>(3 * a).transpose() * za;
      for (Eigen::Index b = 0; b < 3; ++b)
        s.information(a, b) += 0.5 * za.dot(m.block<3, 3>(3 * a, 3 * b) * z.segment<3>(3 * b));
    }
  }
  s.information -= 0.5 * shared.transpose() * f.covariance * shared;
  return s;
}

// Newton's step within bounds: where a component would leave them it stops there, and the others take that
// into account. (Cut afterwards, a component that wants to be negative would pull the others along for good.)
Eigen::Vector3d step_within(const Score& s, const Eigen::Vector3d& lowest, const Eigen::Vector3d& highest) {
  const Eigen::Vector3d unit = s.information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::Matrix3d left = unit.asDiagonal() * s.information * unit.asDiagonal();
  Eigen::Vector3d right = unit.cwiseProduct(s.slope), step = Eigen::Vector3d::Zero();
  std::array<bool, 3> held{};
  for (int round = 0; round < 4; ++round) {  // three components: at most three are stopped
    step = unit.cwiseProduct(linear::solve_ldlt(left, right));
    bool inside = true;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double within = std::clamp(step[k], lowest[k], highest[k]), stop = within / unit[k];
      if (held[static_cast<std::size_t>(k)] || within == step[k]) continue;
      inside = false;
      held[static_cast<std::size_t>(k)] = true;
      right -= stop * left.col(k);
      left.row(k).setZero();
      left.col(k).setZero();
      left(k, k) = 1;
      right[k] = stop;
    }
    if (inside) break;
  }
  return step.cwiseMax(lowest).cwiseMin(highest);
}

std::vector<double> numbers(const Eigen::MatrixXd& m) {
  return {m.data(), m.data() + m.size()};
}

}  // namespace

std::array<double, 36> PoseScatter::covariance(const Noise& noise) const {
  std::array<double, 36> result;
  Eigen::Map<Matrix6>(result.data()) = covariance_of(*this, noise);
  return result;
}

PoseFit fit_poses(const std::vector<NoisyPose>& poses, const Noise& noise, Precision prior_precision) {
  const Fit f = fit(poses, noise, prior_precision);
  return {numbers(f.change), numbers(f.information)};
}

void begin_noise(const std::vector<NoisyPose>& poses, Noise& noise) {
  if (noise.robot_m > 0 && noise.robot_rad > 0) return;
  double turn = 0, shift = 0;
  for (const NoisyPose& pose : poses) {
    const Matrix6 by_tool = effects_of(pose.scatter).leftCols<6>();
    const Vector6 tool = linear::inverse(by_tool) * Eigen::Map<const Vector6>(pose.residual.data());
    turn += tool.head<3>().squaredNorm();
    shift += tool.tail<3>().squaredNorm();
  }
  const double coordinates = 3 * std::max<double>(1, static_cast<double>(poses.size()));
  noise.robot_rad = std::max(least_rad, std::sqrt(turn / coordinates));
  noise.robot_m = std::max(least_m, std::sqrt(shift / coordinates));
  noise.board_rad = acts(poses, &PoseScatter::by_board) ? board_turn_share * noise.robot_rad : 0;
}

double update_noise(const std::vector<NoisyPose>& poses, Noise& noise, Precision prior_precision) {
  if (poses.empty()) return 0;
  Score s = score(poses, noise, fit(poses, noise, prior_precision));
  const Eigen::Vector3d before = Eigen::Vector3d(noise.robot_rad, noise.robot_m, noise.board_rad).cwiseAbs2();
  const Eigen::Vector3d least(least_rad * least_rad, least_m * least_m, least_rad * least_rad);
  const Eigen::Vector3d lowest = (farthest_down * before).cwiseMax(least).cwiseMin(before) - before;
  // Residuals that are far too small for their noise have no average information: the slope says enough.
  for (Eigen::Index k = 0; k < 3; ++k)
    if (before[k] > 0) s.information(k, k) += std::abs(s.slope[k]) / (2 * farthest_up * before[k]);
  const Eigen::Vector3d step = step_within(s, lowest, (farthest_up - 1) * before);
  const Eigen::Vector3d after = (before + step).cwiseSqrt();
  noise.robot_rad = after[0];
  noise.robot_m = after[1];
  noise.board_rad = after[2];
  return std::sqrt(std::max(0.0, s.slope.dot(step)));
}

Noise estimate_noise(const std::vector<NoisyPose>& poses, const Noise& start, Precision prior_precision) {
  Noise noise = start;
  begin_noise(poses, noise);
  for (int k = 0; k < most_updates; ++k)
    if (update_noise(poses, noise, prior_precision) < 1e-6) break;
  return noise;
}

}  // namespace gonio::robot::handeye
