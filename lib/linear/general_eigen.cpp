// See general_eigen.h.
#include "linear/general_eigen.h"

#include <Eigen/Eigenvalues>

namespace gonio::linear {

GeneralEigen::GeneralEigen(const Eigen::MatrixXd& square) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(square);
  info_ = solver.info();
  if (info_ != Eigen::Success) return;
  values_ = solver.eigenvalues();
  vectors_ = solver.eigenvectors();
}

}  // namespace gonio::linear
