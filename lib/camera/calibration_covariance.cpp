// Covariance of an adjustment from its normal equations, poses eliminated by the Schur complement:
//   [A  B_i; B_i' C_i],   S = A - sum B_i C_i^-1 B_i',   cov(lens) = s^2 S^-1,
//   cov(pose i) = s^2 (C_i^-1 + C_i^-1 B_i' S^-1 B_i C_i^-1),
// with s^2 the weighted sum of squares over the degrees of freedom. Parameters are scaled to unit diagonal of A, so
// that the smallest eigenvalue of the scaled S says which share of some direction's information the poses leave.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "camera/bundle_adjustment.h"

namespace gonio::camera {
namespace {

constexpr double least_share = 1e-12;  // of the information that rounding errors cannot feign

using Matrix = Eigen::MatrixXd;
using Pose6 = Eigen::Matrix<double, 6, 6>;

struct NormalEquations {
  Matrix a;               // of the free parameters
  std::vector<Matrix> b;  // free parameters x 6, per view
  std::vector<Pose6> c;
  double squares = 0;      // weighted sum of squared residuals
  double coordinates = 0;  // how many were summed, weights below one counted as such
};

double huber_weight(Vec2 residual, double view_weight, double loss_px) {
  const double size = std::sqrt(view_weight) * norm(residual);
  return size > loss_px ? loss_px / size : 1;
}

NormalEquations normal_equations(const std::vector<View>& views, const Board& board,
                                 const std::vector<FreeParameter>& free, const Adjustment& state) {
  const auto k = static_cast<Eigen::Index>(free.size());
  NormalEquations n{Matrix::Zero(k, k), {}, {}};
  std::array<std::array<double, BoardColumn::count>, 2> j{};
  for (std::size_t i = 0; i < views.size(); ++i) {
    n.b.push_back(Matrix::Zero(k, 6));
    n.c.push_back(Pose6::Zero());
    if (state.view_weights[i] == 0) continue;
    for (const Corner& corner : views[i].corners) {
      Vec2 pixel;
      if (!predict(state.lens, state.poses[i], board.extent(), state.warp, board.corner_m(corner.id), pixel, j))
        continue;
      const Vec2 r = corner.pixel - pixel;
      const double robust = huber_weight(r, state.view_weights[i], state.loss_px);
      const double weight = robust * state.view_weights[i];
      n.squares += weight * dot(r, r);
      n.coordinates += 2 * robust;
      for (const auto& row : j) {
        Eigen::VectorXd g(k);
        for (Eigen::Index p = 0; p < k; ++p) {
          g(p) = 0;
          for (const auto& [column, factor] : free[static_cast<std::size_t>(p)].columns) g(p) += factor * row[column];
        }
        const Eigen::Map<const Eigen::Matrix<double, 6, 1>> h(row.data() + BoardColumn::rotation);
        n.a.noalias() += weight * g * g.transpose();
        n.b[i].noalias() += weight * g * h.transpose();
        n.c[i].noalias() += weight * h * h.transpose();
      }
    }
  }
  return n;
}

}  // namespace

std::vector<FreeParameter> free_parameters(const CalibrationOptions& options, const Intrinsics& lens) {
  const auto held = [&](const std::string& name) { return options.fixed.contains(name); };
  std::vector<FreeParameter> free;
  if (held("aspect")) {
    free.push_back({"fx_px", {{0, 1.0}, {1, lens.fy_px / lens.fx_px}}});
  } else {
    free.push_back({"fx_px", {{0, 1.0}}});
    free.push_back({"fy_px", {{1, 1.0}}});
  }
  if (!held("principal-point")) {
    free.push_back({"cx_px", {{2, 1.0}}});
    free.push_back({"cy_px", {{3, 1.0}}});
  }
  const TermSet& fitted = camera_model_info(options.model, "calibration").fitted;
  for (std::size_t i = 0; i < distortion_terms; ++i) {
    const std::string name(distortion_names[i]);
    if (fitted.has(i) && !held(name)) free.push_back({name, {{BoardColumn::distortion + i, 1.0}}});
  }
  if (options.board_warp) {
    free.push_back({"sag_x_m", {{BoardColumn::warp, 1.0}}});
    free.push_back({"sag_y_m", {{BoardColumn::warp + 1, 1.0}}});
  }
  return free;
}

void estimate_covariance(const std::vector<View>& views, const Board& board, const CalibrationOptions& options,
                         const Adjustment& state, Calibration& result) {
  const std::vector<FreeParameter> free = free_parameters(options, state.lens);
  const NormalEquations n = normal_equations(views, board, free, state);
  const auto k = static_cast<Eigen::Index>(free.size());
  result.order.clear();
  for (const FreeParameter& parameter : free) result.order.push_back(parameter.name);
  const auto used = std::ranges::count_if(state.view_weights, [](double w) { return w > 0; });
  const double freedom = n.coordinates - static_cast<double>(k) - 6.0 * static_cast<double>(used);
  result.covariance.clear();
  result.noise_px = 0;
  if (freedom < 1) return;
  const double variance = n.squares / freedom;
  result.noise_px = std::sqrt(variance);
  Matrix s = n.a;
  std::vector<Pose6> c_inverse(views.size(), Pose6::Zero());
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] == 0) continue;
    c_inverse[i] = n.c[i].ldlt().solve(Pose6::Identity());
    s.noalias() -= n.b[i] * c_inverse[i] * n.b[i].transpose();
  }
  const Eigen::VectorXd scale = n.a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scale.asDiagonal() * s * scale.asDiagonal());
  if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()(0) > least_share)) return;
  const Matrix root = scale.asDiagonal() * eigen.eigenvectors();
  const Matrix lens = root * eigen.eigenvalues().cwiseInverse().asDiagonal() * root.transpose();
  for (Eigen::Index i = 0; i < k; ++i) {
    for (Eigen::Index j = 0; j < k; ++j) result.covariance.push_back(variance * 0.5 * (lens(i, j) + lens(j, i)));
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] == 0) continue;
    const Matrix slope = n.b[i] * c_inverse[i];
    const Pose6 pose = c_inverse[i] + slope.transpose() * lens * slope;
    for (int p = 0; p < 6; ++p) {
      result.views[i].sigma[static_cast<std::size_t>(p)] = std::sqrt(variance * std::max(pose(p, p), 0.0));
    }
  }
}

}  // namespace gonio::camera
