// Derivatives. With M = stand_from_mount implied = Z T^-1 X^-1, T = camera_from_board, and turns applied on the left:
//   turn of Z by w, shift d:   turn of M  w              shift of M  w x (t_M - t_Z) + d
//   turn of T by w, shift d:   turn of M -R_Z R_T' w     shift of M  R_Z R_T' ((c - t_T) x w - d),  c = X^-1 0
//   turn of X by w, shift d:   turn of M -R_M w          shift of M  R_M (w x t_X - d)
// and where the robot says M^-1 (eye-to-hand), N = M^-1: turn of N = -R_N (turn of M), shift of N = -R_N (shift of M +
// t_M x turn of M). The rotation vector of the deviation follows turns by the inverse left Jacobian of the rotation
// group.
#include "robot/handeye/pose_adjustment.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "robot/handeye/pose_noise.h"

namespace gonio::robot::handeye {
namespace {

constexpr int most_steps = 60, noise_steps = 12;

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

// How a deviation scatters: the robot's part acts on it as it is.
PoseScatter scatter_of(const Deviation& d, const ObservedPose& observed) {
  PoseScatter s;
  Eigen::Map<Matrix6>(s.measured.data()) = d.by_pose * observed.covariance * d.by_pose.transpose();
  for (std::size_t k = 0; k < 3; ++k) s.by_turn[7 * k] = s.by_shift[7 * k + 3] = 1;
  Eigen::Map<Eigen::Matrix<double, 6, 3>>(s.by_board.data()) = d.by_board_turn;
  return s;
}

std::vector<NoisyPose> linearise(Kind kind, const std::vector<ObservedPose>& observed, const Solution& solution) {
  std::vector<NoisyPose> rows;
  for (const ObservedPose& o : observed) {
    if (!o.counts) continue;
    const Deviation d = deviation(kind, o, solution);
    NoisyPose row{{}, std::vector<double>(72), scatter_of(d, o)};
    Eigen::Map<Vector6>(row.residual.data()) = d.value;
    Eigen::Map<Matrix6x12>(row.jacobian.data()) = d.by_mountings;
    rows.push_back(std::move(row));
  }
  return rows;
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
  return Eigen::Map<const Matrix6>(scatter_of(d, observed).covariance(noise).data());
}

Matrix12 information(Kind kind, const std::vector<ObservedPose>& observed, const Solution& solution,
                     const Noise& noise) {
  return Eigen::Map<const Matrix12>(fit_poses(linearise(kind, observed, solution), noise).information.data());
}

PoseAdjustment adjust_poses(Kind kind, const std::vector<ObservedPose>& observed, const Solution& start,
                            const Noise& noise) {
  PoseAdjustment result{start, noise};
  auto rows = linearise(kind, observed, result.solution);
  begin_noise(rows, result.noise);
  for (int step = 0; step < most_steps; ++step) {
    const PoseFit fit = fit_poses(rows, result.noise);
    const Eigen::Map<const Vector12> change(fit.change.data());
    const Eigen::Map<const Matrix12> information(fit.information.data());
    const double sigmas = std::sqrt(std::max(0.0, change.dot(information * change)));
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
