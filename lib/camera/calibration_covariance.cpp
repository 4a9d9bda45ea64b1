// Covariance of an adjustment from its normal equations, placements eliminated by the Schur complement:
//   [A  B_p; B_p' C_p],   S = A - sum B_p C_p^-1 B_p',   cov(shared) = s^2 S^-1,   slope_p = -C_p^-1 B_p',
//   cov(placement p) = s^2 C_p^-1 + slope_p cov(shared) slope_p',
// with s^2 the weighted sum of squares over the degrees of freedom. What is not modelled (a bent board, a printer's
// error, a lens term) moves all corners of a shot together, and s^2, an average over corners, does not know it. The
// shots' scores g_i = J_i' W r_i, placements eliminated, do: with the right model cov(g_i) = s^2 (S_i - S_i S^-1 S_i),
//   f = sum g_i' S^-1 g_i / (s^2 (k - sum tr (S^-1 S_i)^2)),   E f = 1,
// is the mean factor, over directions of the shared numbers, by which they scatter more between shots than corners'
// noise explains (Birge's ratio with shots as the witnesses; Birge, Phys. Rev. 40, 1932; Liang & Zeger, Biometrika 73,
// 1986). cov(shared) is multiplied by f where it exceeds 1. Parameters are scaled to unit diagonal of A, so
// that the smallest eigenvalue of the scaled S says which share of some direction's information the poses leave.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <set>

#include "camera/bundle_adjustment.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"

namespace gonio::camera {
namespace {

using Kind = SharedParameter::Kind;
using Matrix = Eigen::MatrixXd;
using Pose6 = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t least_shots = 3;
constexpr double least_share = 1e-12;  // of the information that rounding errors cannot feign

Eigen::Matrix3d eigen_of(const Mat3& m) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m.m.data());
}
Eigen::Matrix3d crossing(Vec3 v) {
  return Eigen::Matrix3d{{0, -v.z, v.y}, {v.z, 0, -v.x}, {-v.y, v.x, 0}};
}

std::array<double, 6> roots(const Pose6& covariance) {
  std::array<double, 6> sigma{};
  for (int i = 0; i < 6; ++i) sigma[static_cast<std::size_t>(i)] = std::sqrt(std::max(covariance(i, i), 0.0));
  return sigma;
}

// Change of camera_from_board for changes of camera_from_rig and of rig_from_board, all on the left.
std::pair<Pose6, Pose6> composition(const CameraFromRig& camera, const PlacedBoard& placed) {
  const Eigen::Matrix3d r = eigen_of(matrix_of(camera.rotation));
  Pose6 by_camera = Pose6::Identity(), by_placement = Pose6::Zero();
  by_camera.block<3, 3>(3, 0) = -crossing(camera.rotate(placed.translation_m));
  by_placement.block<3, 3>(0, 0) = r;
  by_placement.block<3, 3>(3, 3) = r;
  return {by_camera, by_placement};
}

// Places of a camera's six rig parameters in `shared`; none where it is not tied.
std::vector<Eigen::Index> rig_places(const std::vector<SharedParameter>& shared, std::size_t camera) {
  std::vector<Eigen::Index> places;
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (shared[i].kind == Kind::rig && shared[i].of == camera) places.push_back(static_cast<Eigen::Index>(i));
  }
  return places;
}

// Change of rig_from_camera for one of camera_from_rig: it turns by -R' w and moves by -R' (d - w x t).
void store_rig_sigma(const Adjustment& state, const Matrix& covariance, Calibration& result) {
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    const std::vector<Eigen::Index> places = rig_places(result.shared, c);
    if (places.empty()) continue;
    const CameraFromRig& camera = state.camera_from_rig[c];
    const Eigen::Matrix3d back = eigen_of(matrix_of(camera.rotation)).transpose();
    Pose6 inverse = Pose6::Zero();
    inverse.block<3, 3>(0, 0) = -back;
    inverse.block<3, 3>(3, 0) = -back * crossing(camera.translation_m);
    inverse.block<3, 3>(3, 3) = -back;
    const Pose6 own = covariance(places, places);
    result.cameras[c].rig_sigma = roots(inverse * own * inverse.transpose());
  }
}

void store_pose_sigmas(const std::vector<View>& views, const Adjustment& state, const std::vector<Matrix>& slopes,
                       const std::vector<Pose6>& own, const Matrix& covariance, Calibration& result) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] == 0) continue;
    const std::size_t p = state.placement_of[i], c = views[i].camera;
    const auto [by_camera, by_placement] = composition(state.camera_from_rig[c], state.placements[p]);
    Matrix slope = by_placement * slopes[p];
    const std::vector<Eigen::Index> places = rig_places(result.shared, c);
    for (std::size_t k = 0; k < places.size(); ++k) slope.col(places[k]) += by_camera.col(static_cast<Eigen::Index>(k));
    const Pose6 pose = by_placement * own[p] * by_placement.transpose() + Pose6(slope * covariance * slope.transpose());
    result.views[i].sigma = roots(pose);
  }
}

// The inverse of the scaled S; empty where the views leave a direction undetermined.
Matrix shared_inverse(const NormalEquations& n) {
  const Matrix s = schur_complement(n);
  if (s.rows() == 0) return s;
  const Eigen::VectorXd scale = n.a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const linear::SymmetricEigen<Matrix> eigen(scale.asDiagonal() * s * scale.asDiagonal());
  if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()(0) > least_share)) return {};
  const Matrix root = scale.asDiagonal() * eigen.eigenvectors();
  const Matrix inverse = root * eigen.eigenvalues().cwiseInverse().asDiagonal() * root.transpose();
  return 0.5 * (inverse + inverse.transpose());
}

struct Score {
  Eigen::VectorXd g;
  Matrix s;
};
// Of one shot alone: its gradient and information about the shared numbers, placements eliminated.
Score score_of(const std::vector<View>& views, const CalibrationSetup& setup, const std::vector<FreeParameter>& free,
               Adjustment state, std::size_t shot) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].shot != shot) state.view_weights[i] = 0;
  }
  const NormalEquations n = normal_equations(views, setup, free, state);
  Score score{n.g, n.a};
  for (std::size_t p = 0; p < n.c.size(); ++p) {
    if (!(n.c[p](0, 0) > 0)) continue;
    const linear::Ldlt solver(n.c[p]);
    score.g.noalias() -= n.b[p] * solver.solve(n.h[p]);
    score.s.noalias() -= n.b[p] * solver.solve(n.b[p].transpose());
  }
  return score;
}

// f of the head of this file; 1 where there are too few shots to say. `inverse`: S^-1.
double excess_between_shots(const std::vector<View>& views, const CalibrationSetup& setup,
                            const std::vector<FreeParameter>& free, const Adjustment& state, const Matrix& inverse,
                            double variance) {
  std::set<std::size_t> shots;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] > 0) shots.insert(views[i].shot);
  }
  if (shots.size() < least_shots || inverse.rows() == 0) return 1;
  double found = 0, expected = static_cast<double>(inverse.rows());
  for (const std::size_t shot : shots) {
    const Score score = score_of(views, setup, free, state, shot);
    const Matrix share = inverse * score.s;
    found += score.g.dot(inverse * score.g);
    expected -= (share * share).trace();
  }
  return expected > 0 ? found / (variance * expected) : 1;
}

// Peak to valley of the paraboloid over the corners and its sigma: the height spans sag_x from 1 - xi^2 and sag_y from
// 1 - eta^2 alike, so that the range is |a| + |b| where the signs agree or differ, with slopes of +-1.
void store_flatness(Calibration& result) {
  for (std::size_t b = 0; b < result.boards.size(); ++b) {
    CalibratedBoard& board = result.boards[b];
    const SharedParameter x{Kind::board, b, "sag_x_m"}, y{Kind::board, b, "sag_y_m"};
    const auto i = static_cast<std::size_t>(std::ranges::find(result.shared, x) - result.shared.begin());
    const auto j = static_cast<std::size_t>(std::ranges::find(result.shared, y) - result.shared.begin());
    const std::size_t k = result.shared.size();
    if (i >= k || j >= k) continue;
    board.flatness_m = std::abs(board.warp.sag_x_m) + std::abs(board.warp.sag_y_m);
    if (result.covariance.empty()) continue;
    const double sign = std::copysign(1.0, board.warp.sag_x_m) * std::copysign(1.0, board.warp.sag_y_m);
    const auto& v = result.covariance;
    board.flatness_sigma_m = std::sqrt(std::max(0.0, v[i * k + i] + v[j * k + j] + 2 * sign * v[i * k + j]));
  }
}

}  // namespace

void estimate_covariance(const std::vector<View>& views, const CalibrationSetup& setup, const Adjustment& state,
                         Calibration& result) {
  const std::vector<FreeParameter> free = free_parameters(setup, state);
  const NormalEquations n = normal_equations(views, setup, free, state);
  const auto k = static_cast<Eigen::Index>(free.size());
  result.shared.clear();
  for (const FreeParameter& parameter : free) result.shared.push_back(parameter.what);
  const auto used = std::ranges::count_if(n.c, [](const Pose6& c) { return c(0, 0) > 0; });
  const double freedom = n.coordinates - static_cast<double>(k) - 6.0 * static_cast<double>(used);
  result.covariance.clear();
  result.noise_px = 0;
  result.excess = 1;
  store_flatness(result);
  if (freedom < 1) return;
  const double variance = n.squares / freedom;
  result.noise_px = std::sqrt(variance);
  const Matrix inverse = shared_inverse(n);
  if (inverse.rows() != k) return;
  result.excess = excess_between_shots(views, setup, free, state, inverse, variance);
  const Matrix covariance = std::max(1.0, result.excess) * variance * inverse;
  result.covariance.assign(covariance.data(), covariance.data() + covariance.size());
  std::vector<Matrix> slopes(n.c.size(), Matrix::Zero(6, k));
  std::vector<Pose6> own(n.c.size(), Pose6::Zero());
  for (std::size_t p = 0; p < n.c.size(); ++p) {
    if (!(n.c[p](0, 0) > 0)) continue;
    const linear::Ldlt solver(n.c[p]);
    slopes[p] = -solver.solve(n.b[p].transpose());
    own[p] = variance * solver.solve(Pose6::Identity());
    Placement& placement = result.placements[p];
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = slopes[p];
    placement.slope.assign(rows.data(), rows.data() + rows.size());
    std::copy(own[p].data(), own[p].data() + 36, placement.own.begin());  // symmetric
  }
  store_rig_sigma(state, covariance, result);
  store_pose_sigmas(views, state, slopes, own, covariance, result);
  store_flatness(result);
}

}  // namespace gonio::camera
