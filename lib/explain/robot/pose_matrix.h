// Changes of pose and their covariances as matrices (robot/chain/chain.h gives them as plain numbers). Private to
// robot/.
#pragma once
#include <Eigen/Core>

#include "robot/chain/chain.h"

namespace gonio::explain {

using PoseChange = Eigen::Matrix<double, 6, 1>;
using PoseMatrix = Eigen::Matrix<double, 6, 6>;

inline PoseChange vector_of(const robot::Change& change) {
  return Eigen::Map<const PoseChange>(change.data());
}
inline PoseMatrix matrix_of(const robot::ChangeMatrix& m) {
  return Eigen::Map<const PoseMatrix>(m.data());
}

}  // namespace gonio::explain
