// Power iterations on rows, and the certificate of their limit.
#include "nrsfm/solve/motion_manifold.h"

#include <Eigen/Core>

#include "linear/symmetric_eigen.h"

namespace gonio::nrsfm {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// vec by rows: (r_11 r_12 r_13 r_21 r_22 r_23).
Vector6 vec(const CameraRows& rows) {
  Vector6 v;
  v << rows.row(0).transpose(), rows.row(1).transpose();
  return v;
}
CameraRows mat(const Vector6& v) {
  CameraRows rows;
  rows << v.head<3>().transpose(), v.tail<3>().transpose();
  return rows;
}

CameraRows climbed(const Matrix6& a, CameraRows rows) {
  double value = vec(rows).dot(a * vec(rows));
  for (int iteration = 0; iteration < 500; ++iteration) {
    const CameraRows next = nearest_rows(mat(a * vec(rows)));
    const double reached = vec(next).dot(a * vec(next));
    if (!(reached > value)) break;
    rows = next;
    const bool done = reached - value < 1e-13 * reached;
    value = reached;
    if (done) break;
  }
  return rows;
}

bool is_maximum(const Matrix6& a, const CameraRows& rows) {
  const Eigen::Matrix2d product = mat(a * vec(rows)) * rows.transpose();
  const Eigen::Matrix2d multiplier = (product + product.transpose()) / 2;
  Matrix6 slack = -a;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) slack.block<3, 3>(3 * i, 3 * j).diagonal().array() += multiplier(i, j);
  }
  const linear::SymmetricEigen<Matrix6> eigen(slack, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()(0) > -1e-5 * a.trace();
}

}  // namespace

OnManifold nearest_motion(const Eigen::MatrixXd& motion, const CameraRows& start) {
  const Eigen::Index terms = motion.cols() / 3;
  Matrix6 a = Matrix6::Zero();
  for (Eigen::Index k = 0; k < terms; ++k) {
    const Vector6 m = vec(motion.middleCols<3>(3 * k));
    a += m * m.transpose();
  }
  OnManifold best{start, Eigen::VectorXd::Zero(terms), false};
  double value = -1;
  const auto consider = [&](const CameraRows& from) {
    const CameraRows rows = climbed(a, from);
    const double reached = vec(rows).dot(a * vec(rows));
    if (reached <= value * (1 + 1e-12)) return;
    value = reached;
    best.rotation = rows;
    best.certified = is_maximum(a, rows);
  };
  consider(start);
  const linear::SymmetricEigen<Matrix6> eigen(a);
  for (int i = 5; i >= 0 && !best.certified; --i) consider(nearest_rows(mat(eigen.eigenvectors().col(i))));
  for (int i = 5; i >= 1 && !best.certified; --i) {
    for (const double sign : {1.0, -1.0}) {
      consider(nearest_rows(mat(eigen.eigenvectors().col(i) + sign * eigen.eigenvectors().col(i - 1))));
    }
  }
  if (best.rotation.cwiseProduct(start).sum() < 0) best.rotation *= -1;  // [c R] = [(-c) (-R)]
  for (Eigen::Index k = 0; k < terms; ++k) {
    best.weights(k) = motion.middleCols<3>(3 * k).cwiseProduct(best.rotation).sum() / 2;
  }
  return best;
}

}  // namespace gonio::nrsfm
