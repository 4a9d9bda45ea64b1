// Vectors and matrices of room geom as Eigen's.
#pragma once
#include <Eigen/Core>

#include "geom/vector.h"

namespace gonio::linear {

inline Eigen::Vector3d as_eigen(Vec3 v) {
  return {v.x, v.y, v.z};
}
inline Eigen::Matrix3d as_eigen(const Mat3& m) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m.m.data());
}
inline Mat3 mat3_of(const Eigen::Matrix3d& m) {
  Mat3 out;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(out.m.data()) = m;
  return out;
}
// cross_matrix(a) b = a x b.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace gonio::linear
