// One step of damped normal equations, for a Descent (descent.h) whose matrix is dense and small.
//
//   (H + damping diag(H)) d = g       H = J'WJ, g = -J'Wr: downhill
//
// solved with rows and columns scaled to a unit diagonal, so that units of the parameters do not matter (Marquardt
// 1963). A parameter that nothing depends on gets no step. Only the lower triangle of H is read.
#pragma once
#include <Eigen/Core>

#include "linear/solve.h"

namespace gonio::optim {

template <int N>
struct DampedStep {
  Eigen::Matrix<double, N, 1> change;
  double promised = 0;  // fall of sum r^2: 2 g'd - d'Hd
};

template <class Matrix, class Vector>
DampedStep<Vector::RowsAtCompileTime> damped_step(const Eigen::MatrixBase<Matrix>& h,
                                                  const Eigen::MatrixBase<Vector>& downhill, double damping) {
  using Column = Eigen::Matrix<double, Vector::RowsAtCompileTime, 1>;
  const Column diagonal = h.diagonal();
  const Column scale = diagonal.unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 0.0; });
  auto scaled = (scale.asDiagonal() * h.derived() * scale.asDiagonal()).eval();
  scaled.diagonal().setConstant(1 + damping);
  DampedStep<Vector::RowsAtCompileTime> step;
  step.change = scale.cwiseProduct(linear::solve_ldlt(scaled, Column(scale.cwiseProduct(downhill.derived()))));
  step.promised = downhill.dot(step.change) + damping * step.change.dot(diagonal.cwiseProduct(step.change));
  return step;
}

// What the quadratic model promises for another change than the one solved for: one that bounds have cut short.
template <class Matrix, class Vector, class Change>
double promised_fall(const Eigen::MatrixBase<Matrix>& h, const Eigen::MatrixBase<Vector>& downhill,
                     const Eigen::MatrixBase<Change>& change) {
  return change.dot(2 * downhill - h.template selfadjointView<Eigen::Lower>() * change);
}

}  // namespace gonio::optim
