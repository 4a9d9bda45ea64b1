// Principal axes of the shapes that K weights and K basis shapes make, from Gram matrices of size K.
#include "nrsfm/solve/principal_curve.h"

#include <Eigen/Core>

#include "linear/symmetric_eigen.h"

namespace gonio::nrsfm {

Eigen::MatrixXd principal_coordinates(const ShapeTrajectory& fit, Eigen::Index dimensions) {
  const Eigen::Index terms = fit.coefficients.cols();
  Eigen::MatrixXd gram(terms, terms);
  for (Eigen::Index k = 0; k < terms; ++k) {
    for (Eigen::Index l = 0; l < terms; ++l) {
      gram(k, l) = fit.basis.middleRows<3>(3 * k).cwiseProduct(fit.basis.middleRows<3>(3 * l)).sum();
    }
  }
  const linear::SymmetricEigen<Eigen::MatrixXd> shape_axes(gram);
  const Eigen::VectorXd roots = shape_axes.eigenvalues().cwiseMax(0).cwiseSqrt();
  Eigen::MatrixXd along = fit.coefficients * shape_axes.eigenvectors() * roots.asDiagonal();
  along.rowwise() -= along.colwise().mean().eval();
  const linear::SymmetricEigen<Eigen::MatrixXd> axes(along.transpose() * along);
  return along * axes.eigenvectors().rightCols(dimensions).rowwise().reverse();
}

}  // namespace gonio::nrsfm
