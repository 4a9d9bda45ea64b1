#include "linear/svd.h"

#include <Eigen/SVD>
#include <type_traits>

#ifndef __clang__  // which has no such warning
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // singular values, where Eigen gives up on NaN
#endif

namespace gonio::linear {
namespace {

constexpr unsigned any_u = Eigen::ComputeThinU | Eigen::ComputeFullU, any_v = Eigen::ComputeThinV | Eigen::ComputeFullV;

}  // namespace

template <class Matrix>
JacobiSvd<Matrix>::JacobiSvd(const Matrix& a, unsigned options) {
  using Solved = std::conditional_t<Matrix::RowsAtCompileTime == 9, Eigen::MatrixXd, Matrix>;
  const Eigen::JacobiSVD<Solved> svd(a, options);
  values_ = svd.singularValues();
  if (options & any_u) u_ = svd.matrixU();
  if (options & any_v) v_ = svd.matrixV();
}

template class JacobiSvd<Eigen::MatrixXd>;
template class JacobiSvd<Eigen::Matrix2d>;
template class JacobiSvd<Eigen::Matrix3d>;
template class JacobiSvd<Eigen::Matrix<double, 9, 9>>;

DividedSvd::DividedSvd(const Eigen::MatrixXd& a, unsigned options) {
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(a, options);
  values_ = svd.singularValues();
  if (options & any_u) u_ = svd.matrixU();
  if (options & any_v) v_ = svd.matrixV();
}

}  // namespace gonio::linear
