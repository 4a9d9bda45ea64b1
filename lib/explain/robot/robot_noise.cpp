// See robot_noise.h. Sums over views keep it linear in their number: with W = V^-1 and H = J'WJ, the matrix
// P = W - W J H^-1 J' W enters only through traces. Parameters with a prior are random effects: their precision joins
// H.
#include "explain/robot/robot_noise.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "linear/blocks.h"
#include "linear/solve.h"
#include "stats/distributions.h"

namespace gonio::explain {
namespace {

constexpr double floor_rad = 1e-7, floor_m = 1e-7;
constexpr double outlier_level = 1e-6;  // of a view's six numbers by chance

struct Sums {
  Eigen::MatrixXd normal_inverse;
  Eigen::VectorXd estimate;
  Eigen::Vector2d score;
  Eigen::Matrix2d information;
};

// H^-1 on the range of H, columns scaled to unit length.
Eigen::MatrixXd scaled_inverse(const Eigen::MatrixXd& h) {
  const Eigen::VectorXd scale = h.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
  const linear::EigenPairs eigen = linear::eigen_of(scale.asDiagonal() * h * scale.asDiagonal());
  const Eigen::VectorXd inverse = eigen.values.unaryExpr([](double v) { return v > 1e-8 ? 1 / v : 0.0; });
  const Eigen::MatrixXd half = scale.asDiagonal() * eigen.vectors;
  return half * inverse.asDiagonal() * half.transpose();
}

Sums sums_of(const std::vector<NoisyView>& views, const std::vector<bool>& outlier,
             const Eigen::VectorXd& prior_precision, const Eigen::Vector2d& variance) {
  const Eigen::Index n = views[0].jacobian.cols();
  std::vector<PoseMatrix> weight;
  Eigen::MatrixXd normal = prior_precision.asDiagonal();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (std::size_t v = 0; v < views.size(); ++v) {
    weight.push_back(views[v].covariance(std::sqrt(variance[0]), std::sqrt(variance[1])).inverse());
    if (outlier[v]) continue;
    normal += views[v].jacobian.transpose() * weight[v] * views[v].jacobian;
    right += views[v].jacobian.transpose() * (weight[v] * views[v].residual);
  }
  Sums s{scaled_inverse(normal), {}, Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero()};
  s.estimate = s.normal_inverse * right;
  // tr(P A P B) = tr(WAWB) - 2 tr(H^-1 J'W A W B W J) + tr(H^-1 G_A H^-1 G_B), G_A = J'W A W J, for block diagonal A,
  // B.
  std::array<Eigen::MatrixXd, 2> g = {Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (outlier[v]) continue;
    const NoisyView& view = views[v];
    const std::array<const PoseMatrix*, 2> part = {&view.by_rotation, &view.by_shift};
    const PoseChange whitened = weight[v] * (view.residual - view.jacobian * s.estimate);
    const Eigen::MatrixXd wj = weight[v] * view.jacobian;
    for (int a = 0; a < 2; ++a) {
      const PoseMatrix& pa = *part[static_cast<std::size_t>(a)];
      g[static_cast<std::size_t>(a)] += wj.transpose() * pa * wj;
      s.score[a] += 0.5 * (whitened.dot(pa * whitened) - (weight[v] * pa).trace());
      for (int b = 0; b < 2; ++b) {
        const PoseMatrix& pb = *part[static_cast<std::size_t>(b)];
        const PoseMatrix inner = pa * weight[v] * pb;
        s.information(a, b) +=
            0.5 * (weight[v] * inner).trace() - (s.normal_inverse * (wj.transpose() * inner * wj)).trace();
      }
    }
  }
  for (int a = 0; a < 2; ++a) {
    const Eigen::MatrixXd ha = s.normal_inverse * g[static_cast<std::size_t>(a)];
    s.score[a] += 0.5 * ha.trace();
    for (int b = 0; b < 2; ++b)
      s.information(a, b) += 0.5 * (ha * s.normal_inverse * g[static_cast<std::size_t>(b)]).trace();
  }
  return s;
}

// Fisher scoring; a component that would turn negative goes a tenth of its way to zero.
Eigen::Vector2d variances(const std::vector<NoisyView>& views, const std::vector<bool>& outlier,
                          const Eigen::VectorXd& prior_precision, Eigen::Vector2d variance, RobotNoise& noise) {
  const Eigen::Vector2d lowest(floor_rad * floor_rad, floor_m * floor_m);
  for (int i = 0; i < 60; ++i) {
    const Sums s = sums_of(views, outlier, prior_precision, variance);
    noise.estimate = s.estimate;
    noise.covariance = s.normal_inverse;
    // Both components in units of their own present size.
    const Eigen::Matrix2d scaled = variance.asDiagonal() * s.information * variance.asDiagonal();
    const Eigen::Vector2d step =
        linear::solve_ldlt(scaled + 1e-9 * Eigen::Matrix2d::Identity(), Eigen::Vector2d(variance.asDiagonal() * s.score));
    Eigen::Vector2d next = variance;
    for (int k = 0; k < 2; ++k) next[k] = std::max(lowest[k], variance[k] * std::clamp(1 + step[k], 0.1, 10.0));
    const double change = ((next - variance).cwiseQuotient(variance)).cwiseAbs().maxCoeff();
    variance = next;
    if (change < 1e-6) break;
  }
  return variance;
}

}  // namespace

RobotNoise robot_noise(const std::vector<NoisyView>& views, const Eigen::VectorXd& prior_precision) {
  RobotNoise noise;
  noise.outlier.assign(views.size(), false);
  Eigen::Vector2d variance(1e-3 * 1e-3, 1e-3 * 1e-3);
  const double limit = stats::chi2_quantile(1 - outlier_level, 6);
  for (std::size_t removed = 0; removed <= views.size() / 10; ++removed) {
    variance = variances(views, noise.outlier, prior_precision, variance, noise);
    noise.rotation_rad = std::sqrt(variance[0]);
    noise.shift_m = std::sqrt(variance[1]);
    double worst = 0;
    std::size_t at = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (noise.outlier[v]) continue;
      const PoseChange r = views[v].residual - views[v].jacobian * noise.estimate;
      const double distance = r.dot(linear::solve_ldlt(views[v].covariance(noise.rotation_rad, noise.shift_m), r));
      if (distance > worst) worst = distance, at = v;
    }
    if (worst <= limit || removed == views.size() / 10) break;
    noise.outlier[at] = true;
  }
  return noise;
}

}  // namespace gonio::explain
