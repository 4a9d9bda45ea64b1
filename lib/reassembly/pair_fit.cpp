// Procrustes' problem with a covariance on either side: Kabsch's rotation to begin with, then Gauss-Newton.
#include "camera/quality/alignment.h"
#include "linear/geom_matrices.h"
#include "linear/positive.h"
#include "linear/symmetric_eigen.h"
#include "reassembly/pair_match.h"

namespace gonio::reassembly {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Whether the markers span a plane at least, beyond their uncertainty.
bool spread_out(std::span<const Spot> markers, std::span<const Pairing> pairs) {
  Vector3d mean = Vector3d::Zero();
  double noise = 0;
  for (const auto& [m, b] : pairs) mean += markers[m].at / static_cast<double>(pairs.size());
  Matrix3d spread = Matrix3d::Zero();
  for (const auto& [m, b] : pairs) {
    spread += (markers[m].at - mean) * (markers[m].at - mean).transpose();
    noise = std::max(noise, markers[m].covariance.trace());
  }
  const Vector3d values = linear::SymmetricEigen<Matrix3d>(spread, Eigen::EigenvaluesOnly).eigenvalues();
  return values[1] > 1e-6 * values[2] && values[1] > 9 * noise;
}

std::array<double, 9> flat_matrix3(const Matrix3d& m) {
  std::array<double, 9> a;
  Eigen::Map<Matrix3d>(a.data()) = m;
  return a;
}

}  // namespace

std::optional<PointFit> fit_points(std::span<const Spot> markers, std::span<const Spot> points,
                                   std::span<const Pairing> pairs, bool free_scale) {
  using Matrix7 = Eigen::Matrix<double, 7, 7>;
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  if (pairs.size() < 3 || !spread_out(markers, pairs)) return {};
  PointFit f;
  Vector3d mean = Vector3d::Zero();
  for (const auto& [m, b] : pairs) {
    f.centroid += points[b].at / static_cast<double>(pairs.size());
    mean += markers[m].at / static_cast<double>(pairs.size());
  }
  std::vector<Vec3> from, to;
  double above = 0, below = 0;
  for (const auto& [m, b] : pairs) {
    const Vector3d x = markers[m].at - mean, y = points[b].at - f.centroid;
    from.push_back({x.x(), x.y(), x.z()});
    to.push_back({y.x(), y.y(), y.z()});
    above += y.squaredNorm();
    below += x.squaredNorm();
  }
  f.rotation = linear::as_eigen(matrix_of(camera::aligned(from, to).rotation));
  if (free_scale) f.scale = std::sqrt(above / below);
  f.place = f.centroid - f.scale * f.rotation * mean;
  for (int step = 0; step < 4; ++step) {
    Matrix7 h = Matrix7::Zero();
    Vector7 downhill = Vector7::Zero();
    f.chi_square = 0;
    if (!free_scale) h(6, 6) = 1;
    for (const auto& [m, b] : pairs) {
      const Vector3d there = f.rotation * (f.scale * markers[m].at) + f.place, r = there - points[b].at;
      const Matrix3d all =
          f.scale * f.scale * f.rotation * markers[m].covariance * f.rotation.transpose() + points[b].covariance;
      std::array<double, 9> inverse;
      if (!linear::positive_inverse<3>(flat_matrix3(all), inverse)) return {};
      const Matrix3d w = Eigen::Map<const Matrix3d>(inverse.data());
      Eigen::Matrix<double, 3, 7> j;
      j << -linear::cross_matrix(there - f.centroid), Matrix3d::Identity(),
          (free_scale ? Vector3d(there - f.centroid) : Vector3d::Zero());
      h += j.transpose() * w * j;
      downhill -= j.transpose() * (w * r);
      f.chi_square += r.dot(w * r);
    }
    std::array<double, 49> a, inverse;
    Eigen::Map<Matrix7>(a.data()) = h;
    if (!linear::positive_inverse<7>(a, inverse)) return {};
    f.covariance = Eigen::Map<const Matrix7>(inverse.data());
    if (!free_scale) f.covariance(6, 6) = 0;
    if (step == 3) break;
    const Vector7 change = f.covariance * downhill;
    const Matrix3d turn = linear::as_eigen(matrix_of(quaternion_of_rotation_vector({change[0], change[1], change[2]})));
    const double grow = std::exp(change[6]);
    f.place = f.centroid + change.segment<3>(3) + grow * (turn * (f.place - f.centroid));
    f.rotation = turn * f.rotation;
    f.scale *= grow;
    if (change.dot(downhill) < 1e-6) step = 2;  // at rest: once more for the covariance
  }
  return f;
}

}  // namespace gonio::reassembly
