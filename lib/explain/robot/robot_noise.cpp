// See robot_noise.h.
#include "explain/robot/robot_noise.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "explain/blocks.h"
#include "linear/solve.h"
#include "stats/distributions.h"

namespace gonio::explain {
namespace {

constexpr double outlier_level = 1e-6;      // of a view's six numbers by chance
constexpr double least_information = 1e-8;  // lengths of links and mountings that imitate each other

}  // namespace

RobotNoise robot_noise(const std::vector<NoisyView>& views, const Eigen::VectorXd& prior_precision) {
  RobotNoise noise;
  noise.outlier.assign(views.size(), false);
  const double limit = stats::chi2_quantile(1 - outlier_level, 6);
  for (std::size_t removed = 0; removed <= views.size() / 10; ++removed) {
    std::vector<robot::handeye::NoisyPose> poses;
    for (std::size_t v = 0; v < views.size(); ++v)
      if (!noise.outlier[v]) poses.push_back(views[v].pose());
    const robot::handeye::NoiseStep step = estimate_noise(poses, prior_precision, noise.sizes, least_information);
    noise.estimate = step.change;
    noise.covariance = step.covariance;
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
