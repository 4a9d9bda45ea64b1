#include "mesh/register/figures.h"

#include <algorithm>
#include <cmath>

#include "linear/blocks.h"
#include "linear/geom_matrices.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

// Of sum of squares over count by patches: variance of a ratio of sums. Few patches know their own scatter badly; as
// much is added as makes 1.96 standard deviations hold what Student's t holds.
double ratio_variance(const std::map<Patch, std::pair<double, double>>& patches, double mean, double count) {
  const auto n = static_cast<double>(patches.size());
  if (n < 2) return mean * mean;
  double sum = 0, weights = 0;
  for (const auto& [at, patch] : patches) {
    const double off = patch.first - mean * patch.second;
    sum += off * off, weights += patch.second * patch.second;
  }
  const double equal = count * count / weights;  // patches of one weight that would say as much
  const double wider = stats::student_quantile(0.975, std::max(1.0, equal - 1)) / stats::normal_quantile(0.975);
  return wider * wider * n / (n - 1) * sum / (count * count);
}

// P(F > value).
double fisher_upper(double value, double above, double below) {
  return value <= 0 ? 1 : stats::beta_regularised(below / (below + above * value), 0.5 * below, 0.5 * above);
}

double root_sigma(double mean_square, double variance) {
  return mean_square > 0 ? 0.5 * std::sqrt(variance / mean_square) : 0;
}

double typical_of(const std::vector<const ViewOverlap*>& overlaps) {
  std::vector<double> sizes;
  for (const ViewOverlap* o : overlaps)
    for (const OverlapPoint& p : o->points) sizes.push_back(std::abs(p.residual.off_m) / p.residual.sigma_m);
  return sizes.empty() ? 0 : stats::sigma_of_median * stats::median(sizes);
}

}  // namespace

Split split_of(std::span<const PairSums> pairs, std::size_t views, std::size_t fixed) {
  const JointSystem system = joint_of(pairs, views, fixed);
  const Filled filled = filled_directions(system);
  Split made;
  made.x = Eigen::VectorXd::Zero(system.unknowns());
  made.held = static_cast<int>(filled.values.size());
  // By the raw information, so that squares add up.
  const linear::EigenPairs parts = linear::eigen_of(filled.directions.transpose() * system.raw * filled.directions);
  const Eigen::VectorXd along = parts.vectors.transpose() * (filled.directions.transpose() * system.pull);
  const Eigen::VectorXd shares = along.cwiseAbs2().cwiseQuotient(parts.values);
  if (made.held > 0) made.x = filled.directions * (parts.vectors * along.cwiseQuotient(parts.values));
  std::map<Patch, std::pair<double, double>> left;
  double squares = 0;
  for (const PairSums& pair : pairs) {
    const Vector6 moved = system.motion_of(made.x, pair.first) - system.motion_of(made.x, pair.second);
    squares += pair.all.squares;
    for (const auto& [at, patch] : pair.patches) {
      auto& own = left[at];
      own.first += patch.squares - 2 * moved.dot(patch.pull) + moved.dot(patch.squared * moved);
      own.second += patch.residuals;
    }
  }
  const double n = std::max(1.0, system.residuals), explained = made.held > 0 ? shares.sum() : 0;
  made.mean_square = squares / n, made.explained = explained / n, made.left = (squares - explained) / n;
  made.left_variance = ratio_variance(left, made.left, n);
  made.variance = made.left_variance;
  if (made.held == 0) return made;
  const double inflation = inflation_of(filled, scatter_after(pairs, system, made.x));
  for (Eigen::Index k = 0; k < shares.size(); ++k) {
    const double beyond = std::max(0.0, shares[k] - inflation) / n;
    made.variance += 2 * beyond * beyond;
  }
  made.p = fisher_upper(explained / (inflation * made.held), made.held, std::max(1.0, system.patches - made.held));
  return made;
}

std::vector<PairFigures> pair_figures(const std::vector<ViewOverlap>& overlaps, const std::vector<PairSums>& pairs,
                                      const MotionScale& scale) {
  std::vector<PairFigures> all;
  for (const PairSums& pair : pairs) {
    PairFigures f;
    f.first = pair.first, f.second = pair.second;
    std::vector<const ViewOverlap*> both;
    Vec3 middle;
    double squares = 0;
    for (const ViewOverlap& o : overlaps) {
      if (std::minmax(o.view, o.other) != std::minmax(pair.first, pair.second)) continue;
      both.push_back(&o);
      if (o.asked > 0)
        f.overlap[o.view == pair.first ? 0 : 1] = static_cast<double>(o.points.size()) / static_cast<double>(o.asked);
      for (const OverlapPoint& p : o.points) middle += p.residual.at_m, squares += p.residual.off_m * p.residual.off_m;
    }
    middle *= 1 / pair.all.residuals;
    PairSums alone = pair;
    alone.first = 0, alone.second = 1;
    const Split split = split_of({&alone, 1}, 2, 1);
    f.residuals = static_cast<std::size_t>(pair.all.residuals), f.patches = pair.patches.size();
    f.rms_m = std::sqrt(squares / pair.all.residuals);
    f.consistency = std::sqrt(split.mean_square), f.sigma = root_sigma(split.mean_square, split.variance);
    f.typical = typical_of(both);
    f.rigid = std::sqrt(split.explained), f.rigid_p = split.p, f.held = split.held;
    f.rest = std::sqrt(std::max(0.0, split.left)), f.rest_sigma = root_sigma(split.left, split.left_variance);
    const Eigen::Vector3d turn = split.x.head<3>() / scale.length_m;
    f.turn_rad = turn.norm();
    f.shift_m = (split.x.tail<3>() + linear::cross_matrix(turn) * linear::as_eigen(middle - scale.centre_m)).norm();
    all.push_back(f);
  }
  return all;
}

Consistency consistency_of(const std::vector<ViewOverlap>& overlaps, const std::vector<PairSums>& pairs,
                           std::size_t views, std::size_t fixed) {
  const Split split = split_of(pairs, views, fixed);
  Consistency all;
  all.value = std::sqrt(split.mean_square), all.sigma = root_sigma(split.mean_square, split.variance);
  all.rigid = std::sqrt(split.explained), all.rigid_p = split.p;
  all.rest = std::sqrt(std::max(0.0, split.left)), all.rest_sigma = root_sigma(split.left, split.left_variance);
  std::vector<const ViewOverlap*> every;
  std::map<Patch, int> patches;
  for (const ViewOverlap& o : overlaps) every.push_back(&o);
  for (const PairSums& pair : pairs) {
    all.residuals += static_cast<std::size_t>(pair.all.residuals);
    for (const auto& [at, patch] : pair.patches) patches[at] = 1;
  }
  all.typical = typical_of(every), all.patches = patches.size();
  return all;
}

}  // namespace gonio::mesh
