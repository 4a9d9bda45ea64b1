// See robot_noise.h.
#include "explain/robot/robot_noise.h"

#include <algorithm>

#include "linear/solve.h"
#include "stats/distributions.h"

namespace gonio::explain {
namespace {

using robot::handeye::NoisyPose;

constexpr double outlier_level = 1e-6;  // of a view's six numbers by chance

NoisyPose pose_of(const NoisyView& view) {
  NoisyPose pose{{}, std::vector<double>(static_cast<std::size_t>(view.jacobian.size())), view.scatter};
  std::ranges::copy(view.residual, pose.residual.begin());
  std::ranges::transform(view.jacobian.reshaped(), pose.jacobian.begin(), [](double slope) { return -slope; });
  return pose;
}

robot::handeye::Precision span_of(const Eigen::VectorXd& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

}  // namespace

PoseMatrix NoisyView::covariance(const robot::handeye::Noise& noise) const {
  return Eigen::Map<const PoseMatrix>(scatter.covariance(noise).data());
}

robot::handeye::Noise noise_of(const std::vector<NoisyView>& views, const Eigen::VectorXd& prior_precision) {
  std::vector<NoisyPose> poses;
  for (const NoisyView& view : views) poses.push_back(pose_of(view));
  return estimate_noise(poses, {}, span_of(prior_precision));
}

RobotNoise robot_noise(const std::vector<NoisyView>& views, const Eigen::VectorXd& prior_precision) {
  RobotNoise noise;
  noise.outlier.assign(views.size(), false);
  const double limit = stats::chi2_quantile(1 - outlier_level, 6);
  for (std::size_t removed = 0; removed <= views.size() / 10; ++removed) {
    std::vector<NoisyPose> poses;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (noise.outlier[v]) continue;
      poses.push_back(pose_of(views[v]));
      poses.back().scatter.by_board = {};
    }
    noise.sizes = estimate_noise(poses, noise.sizes, span_of(prior_precision));
    const robot::handeye::PoseFit fit = fit_poses(poses, noise.sizes, span_of(prior_precision));
    noise.estimate = Eigen::Map<const Eigen::VectorXd>(fit.change.data(), prior_precision.size());
    double worst = 0;
    std::size_t at = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (noise.outlier[v]) continue;
      const PoseChange r = views[v].residual - views[v].jacobian * noise.estimate;
      const double distance = r.dot(linear::solve_ldlt(views[v].covariance(noise.sizes), r));
      if (distance > worst) worst = distance, at = v;
    }
    if (worst <= limit || removed == views.size() / 10) break;
    noise.outlier[at] = true;
  }
  return noise;
}

}  // namespace gonio::explain
