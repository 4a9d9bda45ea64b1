// Derivatives. With M = stand_from_mount implied = Z T^-1 X^-1, T = camera_from_board, and turns applied on the left:
//   turn of Z by w, shift d:   turn of M  w              shift of M  w x (t_M - t_Z) + d
//   turn of T by w, shift d:   turn of M -R_Z R_T' w     shift of M  R_Z R_T' ((c - t_T) x w - d),  c = X^-1 0
//   turn of X by w, shift d:   turn of M -R_M w          shift of M  R_M (w x t_X - d)
// and where the robot says M^-1 (eye-to-hand), N = M^-1: turn of N = -R_N (turn of M), shift of N = -R_N (shift of M +
// t_M x turn of M). The rotation vector of the deviation follows turns by the inverse left Jacobian of the rotation
// group.
#include "robot/handeye/pose_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "linear/symmetric_eigen.h"

namespace gonio::robot::handeye {
namespace {

constexpr int most_steps = 60, noise_steps = 12;
constexpr double least_m = 1e-9, least_rad = 1e-9;
constexpr double board_turn_share = 0.3;  // of the robot's turn, to begin with

Matrix3 inverse_left_jacobian(const Vector3& v) {
  const Matrix3 k = cross_matrix(v);
  const double a = v.norm();
  const double second = a < 1e-3 ? 1.0 / 12 + a * a / 720 : (1 - a / 2 / std::tan(a / 2)) / (a * a);
  return Matrix3::Identity() - 0.5 * k + second * k * k;
}

template <class To, class From>
Rigid<To, From> moved(const Rigid<To, From>& pose, const Eigen::Ref<const Vector6>& change) {
  return {normalized(quaternion_of_rotation_vector({change(0), change(1), change(2)}) * pose.rotation),
          pose.translation_m + Vec3{change(3), change(4), change(5)}};
}

struct Linearised {
  Vector6 e;
  Matrix6x12 j;
  Matrix6 camera;  // covariance that the corners bring
  Eigen::Matrix<double, 6, 3> turn;
};

std::vector<Linearised> linearise(Kind kind, const std::vector<ObservedPose>& observed, const Solution& solution) {
  std::vector<Linearised> rows;
  for (const ObservedPose& o : observed) {
    if (!o.counts) continue;
    const Deviation d = deviation(kind, o, solution);
    rows.push_back({d.value, d.by_mountings, d.by_pose * o.covariance * d.by_pose.transpose(), d.by_board_turn});
  }
  return rows;
}

Matrix6 covariance_of(const Matrix6& camera, const Eigen::Matrix<double, 6, 3>& turn, const Noise& noise) {
  Matrix6 v = camera + noise.board_rad * noise.board_rad * turn * turn.transpose();
  v.diagonal().head<3>().array() += noise.robot_rad * noise.robot_rad;
  v.diagonal().tail<3>().array() += noise.robot_m * noise.robot_m;
  return v;
}

struct Normal {
  Matrix12 information = Matrix12::Zero();
  Vector12 gradient = Vector12::Zero();
};
Normal normal_equations(const std::vector<Linearised>& rows, const Noise& noise) {
  Normal n;
  for (const Linearised& row : rows) {
    const Matrix6x12 weighted = linear::solve_ldlt(covariance_of(row.camera, row.turn, noise), row.j);
    n.information.noalias() += row.j.transpose() * weighted;
    n.gradient.noalias() += weighted.transpose() * row.e;
  }
  return n;
}

// Symmetric solve under unit diagonal; directions without information stay where they are.
Matrix12 pseudo_inverse(const Matrix12& n) {
  const Vector12 scale = n.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const linear::SymmetricEigen<Matrix12> e(scale.asDiagonal() * n * scale.asDiagonal());
  Vector12 inverse = Vector12::Zero();
  for (int i = 0; i < 12; ++i) inverse(i) = e.eigenvalues()(i) > 1e-12 ? 1 / e.eigenvalues()(i) : 0;
  const Matrix12 root = scale.asDiagonal() * e.eigenvectors();
  return root * inverse.asDiagonal() * root.transpose();
}

// One update of the variances at a fixed linearisation: v <- v (y' G G' y) / trace(G' P G), y = P e, with G the rows or
// the columns through which each of them acts.
double update_noise(const std::vector<Linearised>& rows, Noise& noise) {
  const Normal n = normal_equations(rows, noise);
  const Matrix12 inverse = pseudo_inverse(n.information);
  const Vector12 change = -inverse * n.gradient;
  double squares_r = 0, squares_t = 0, squares_b = 0, trace_r = 0, trace_t = 0, trace_b = 0;
  for (const Linearised& row : rows) {
    const auto solver = covariance_of(row.camera, row.turn, noise).ldlt();
    const Vector6 y = solver.solve(row.e + row.j * change);
    const Matrix6x12 weighted = solver.solve(row.j);
    const Matrix6 p = Matrix6(solver.solve(Matrix6::Identity())) - weighted * inverse * weighted.transpose();
    squares_r += y.head<3>().squaredNorm();
    squares_t += y.tail<3>().squaredNorm();
    trace_r += p.diagonal().head<3>().sum();
    trace_t += p.diagonal().tail<3>().sum();
    squares_b += (row.turn.transpose() * y).squaredNorm();
    trace_b += (row.turn.transpose() * p * row.turn).trace();
  }
  const auto updated = [](double sigma, double squares, double trace, double least) {
    if (!(trace > 0)) return sigma;
    return std::max(least, sigma * std::sqrt(std::clamp(squares / trace, 1e-2, 1e2)));
  };
  const Noise before = noise;
  noise.robot_rad = updated(noise.robot_rad, squares_r, trace_r, least_rad);
  noise.robot_m = updated(noise.robot_m, squares_t, trace_t, least_m);
  noise.board_rad = updated(noise.board_rad, squares_b, trace_b, least_rad);
  // A variance on its way to zero takes long and matters little: changes count by their share of what they join.
  const double board_share = std::min(1.0, noise.board_rad / noise.robot_rad);
  return std::max({std::abs(std::log(noise.robot_rad / before.robot_rad)),
                   std::abs(std::log(noise.robot_m / before.robot_m)),
                   board_share * board_share * std::abs(std::log(noise.board_rad / before.board_rad))});
}

}  // namespace

Deviation deviation(Kind kind, const ObservedPose& observed, const Solution& s) {
  const auto implied = s.stand_from_board * inverse(observed.camera_from_board) * inverse(s.mount_from_camera);
  const Vector3 t_m = eigen_of(implied.translation_m), t_x = eigen_of(s.mount_from_camera.translation_m);
  const Vector3 t_z = eigen_of(s.stand_from_board.translation_m);
  const Vector3 t_t = eigen_of(observed.camera_from_board.translation_m);
  const Vector3 c = eigen_of(inverse(s.mount_from_camera).translation_m);
  const Matrix3 r_m = eigen_of(implied.rotation);
  const Matrix3 r_zt =
      eigen_of(s.stand_from_board.rotation) * eigen_of(observed.camera_from_board.rotation).transpose();
  Deviation d;
  d.by_pose << -r_zt, Matrix3::Zero(), r_zt * cross_matrix(c - t_t), -r_zt;
  d.by_mountings << -r_m, Matrix3::Zero(), Matrix3::Identity(), Matrix3::Zero(),  //
      -r_m * cross_matrix(t_x), -r_m, -cross_matrix(t_m - t_z), Matrix3::Identity();
  Rigid<frame::Base, frame::Tool> tool{implied.rotation, implied.translation_m};
  if (kind == Kind::eye_to_hand) {
    const auto n = inverse(implied);
    tool = {n.rotation, n.translation_m};
    const Matrix3 r_n = eigen_of(n.rotation);
    Matrix6 turned;
    turned << -r_n, Matrix3::Zero(), -r_n * cross_matrix(t_m), -r_n;
    d.by_pose = turned * d.by_pose;
    d.by_mountings = turned * d.by_mountings;
  }
  const Vector3 turn = eigen_of(rotation_vector_of(tool.rotation * conjugate(observed.base_from_tool.rotation)));
  d.value << turn, eigen_of(tool.translation_m - observed.base_from_tool.translation_m);
  const Matrix3 log = inverse_left_jacobian(turn);
  const Vector3 arm = eigen_of(observed.camera_from_board.rotate(observed.middle_m));
  d.by_pose.topRows<3>() = (log * d.by_pose.topRows<3>()).eval();
  d.by_mountings.topRows<3>() = (log * d.by_mountings.topRows<3>()).eval();
  d.by_board_turn = d.by_pose.leftCols<3>() + d.by_pose.rightCols<3>() * cross_matrix(arm);
  return d;
}

Solution moved_by(const Solution& s, const Vector12& change) {
  return {moved(s.mount_from_camera, change.head<6>()), moved(s.stand_from_board, change.tail<6>())};
}

Matrix6 deviation_covariance(const Deviation& d, const ObservedPose& observed, const Noise& noise) {
  return covariance_of(d.by_pose * observed.covariance * d.by_pose.transpose(), d.by_board_turn, noise);
}

Matrix12 information(Kind kind, const std::vector<ObservedPose>& observed, const Solution& solution,
                     const Noise& noise) {
  return normal_equations(linearise(kind, observed, solution), noise).information;
}

PoseAdjustment adjust_poses(Kind kind, const std::vector<ObservedPose>& observed, const Solution& start,
                            const Noise& noise) {
  PoseAdjustment result{start, noise};
  auto rows = linearise(kind, observed, result.solution);
  if (!(noise.robot_m > 0) || !(noise.robot_rad > 0)) {
    double turn = 0, shift = 0;
    for (const Linearised& row : rows) {
      turn += row.e.head<3>().squaredNorm();
      shift += row.e.tail<3>().squaredNorm();
    }
    const double coordinates = 3 * std::max<double>(1, static_cast<double>(rows.size()));
    result.noise.robot_rad = std::max(least_rad, std::sqrt(turn / coordinates));
    result.noise.robot_m = std::max(least_m, std::sqrt(shift / coordinates));
    result.noise.board_rad = board_turn_share * result.noise.robot_rad;
  }
  for (int step = 0; step < most_steps; ++step) {
    const Normal n = normal_equations(rows, result.noise);
    const Vector12 change = -pseudo_inverse(n.information) * n.gradient;
    const double sigmas = std::sqrt(std::max(0.0, change.dot(n.information * change)));
    result.solution = moved_by(result.solution, change);
    rows = linearise(kind, observed, result.solution);
    double moved_noise = 0;
    for (int k = 0; k < noise_steps; ++k) {
      moved_noise = update_noise(rows, result.noise);
      if (moved_noise < 1e-9) break;
    }
    result.converged = sigmas < 1e-7 && moved_noise < 1e-5;
    if (result.converged && sigmas < 1e-9) break;
  }
  return result;
}

}  // namespace gonio::robot::handeye
