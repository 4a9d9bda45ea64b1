// All pairs as one system in the motions of all views but one, and what of it is held.
//
//   squared x = pull       x: motions as in overlap.h, one behind the other
//
// `squared` is the information of independent residuals with exact normals; what errors of normals add to it has been
// taken off, and directions in which no more than as much is left count as empty.
#pragma once
#include <Eigen/Core>
#include <span>

#include "mesh/register/overlap.h"

namespace gonio::mesh {

struct JointSystem {
  std::vector<int> place;        // of each view's six unknowns; -1: it stays
  Eigen::MatrixXd squared, raw;  // raw: with what errors of normals add
  Eigen::VectorXd pull;
  double residuals = 0, patches = 0;  // patches: of each pair, together

  Eigen::Index unknowns() const { return pull.size(); }
  Vector6 motion_of(const Eigen::VectorXd& x, std::size_t view) const {
    return place[view] < 0 ? Vector6::Zero() : Vector6(x.segment<6>(place[view]));
  }
};
JointSystem joint_of(std::span<const PairSums> pairs, std::size_t views, std::size_t fixed);

// Columns: orthonormal directions in which `squared` holds anything, weakest first; their eigenvalues beside.
struct Filled {
  Eigen::MatrixXd directions;
  Eigen::VectorXd values;
};
Filled filled_directions(const JointSystem& system);

// Of the sum of all pulls after the motion x: covariance by patches of the world, with what x has taken of it put back.
Eigen::MatrixXd scatter_after(std::span<const PairSums> pairs, const JointSystem& system, const Eigen::VectorXd& x);

// Variance of the motions in those directions over that of independent residuals, at least 1.
double inflation_of(const Filled& filled, const Eigen::MatrixXd& scatter);

}  // namespace gonio::mesh
