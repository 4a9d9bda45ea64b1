#include "mesh/register/joint_system.h"

#include <algorithm>

#include "linear/blocks.h"

namespace gonio::mesh {

JointSystem joint_of(std::span<const PairSums> pairs, std::size_t views, std::size_t fixed) {
  JointSystem system;
  int next = 0;
  for (std::size_t v = 0; v < views; ++v) {
    system.place.push_back(v == fixed ? -1 : next);
    if (v != fixed) next += 6;
  }
  system.raw.setZero(next, next), system.pull.setZero(next);
  Eigen::MatrixXd noise = system.raw;
  for (const PairSums& pair : pairs) {
    const int a = system.place[pair.first], b = system.place[pair.second];
    system.residuals += pair.all.residuals, system.patches += static_cast<double>(pair.patches.size());
    const auto into = [&](Eigen::MatrixXd& m, const Matrix6& block) {
      if (a >= 0) m.block<6, 6>(a, a) += block;
      if (b >= 0) m.block<6, 6>(b, b) += block;
      if (a >= 0 && b >= 0) m.block<6, 6>(a, b) -= block, m.block<6, 6>(b, a) -= block;
    };
    into(system.raw, pair.all.squared), into(noise, pair.by_noise);
    if (a >= 0) system.pull.segment<6>(a) += pair.all.pull;
    if (b >= 0) system.pull.segment<6>(b) -= pair.all.pull;
  }
  system.squared = system.raw - noise;
  return system;
}

Filled filled_directions(const JointSystem& system) {
  const linear::EigenPairs pairs = linear::eigen_of(system.squared);
  const double least = 1e-12 * std::max(0.0, pairs.largest());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < pairs.values.size(); ++k) {
    const Eigen::VectorXd v = pairs.vectors.col(k);
    const double by_noise = v.dot(system.raw * v) - pairs.values[k];
    if (pairs.values[k] > least && pairs.values[k] > by_noise) kept.push_back(k);
  }
  Filled filled{Eigen::MatrixXd(system.unknowns(), kept.size()), Eigen::VectorXd(kept.size())};
  for (std::size_t k = 0; k < kept.size(); ++k) {
    filled.directions.col(static_cast<Eigen::Index>(k)) = pairs.vectors.col(kept[k]);
    filled.values[static_cast<Eigen::Index>(k)] = pairs.values[kept[k]];
  }
  return filled;
}

Eigen::MatrixXd scatter_after(std::span<const PairSums> pairs, const JointSystem& system, const Eigen::VectorXd& x) {
  std::map<Patch, Eigen::VectorXd> pulls;
  for (const PairSums& pair : pairs) {
    const Vector6 moved = system.motion_of(x, pair.first) - system.motion_of(x, pair.second);
    const int a = system.place[pair.first], b = system.place[pair.second];
    for (const auto& [at, patch] : pair.patches) {
      Eigen::VectorXd& all = pulls.try_emplace(at, Eigen::VectorXd::Zero(system.unknowns())).first->second;
      const Vector6 left = patch.pull - patch.squared * moved;
      if (a >= 0) all.segment<6>(a) += left;
      if (b >= 0) all.segment<6>(b) -= left;
    }
  }
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(system.unknowns(), system.unknowns());
  for (const auto& [at, pull] : pulls) scatter += pull * pull.transpose();
  const auto unknowns = static_cast<double>(system.unknowns());
  // Fewer patches than unknowns say nothing about what is left.
  return scatter * (system.patches > unknowns + 1 ? system.patches / (system.patches - unknowns) : 1e12);
}

double inflation_of(const Filled& filled, const Eigen::MatrixXd& scatter) {
  double sum = 0;
  for (Eigen::Index k = 0; k < filled.values.size(); ++k) {
    const Eigen::VectorXd v = filled.directions.col(k);
    sum += v.dot(scatter * v) / filled.values[k];
  }
  return filled.values.size() == 0 ? 1 : std::max(1.0, sum / static_cast<double>(filled.values.size()));
}

}  // namespace gonio::mesh
