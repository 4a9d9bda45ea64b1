// See tracks_pose.h.
#include "explain/tables/tracks_pose.h"

#include <Eigen/Core>
#include <cmath>

#include "linear/qr.h"
#include "linear/solve.h"
#include "linear/svd.h"

namespace gonio::explain::tables {

WeakPose weak_pose(std::span<const Vec3> points_m, std::span<const Vec2> pixels) {
  const double n = static_cast<double>(points_m.size());
  WeakPose pose;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    pose.centre_m = pose.centre_m + points_m[i] * (1 / n);
    pose.shift_px = pose.shift_px + pixels[i] * (1 / n);
  }
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 2, 3> cross = Eigen::Matrix<double, 2, 3>::Zero();
  double spread_px2 = 0;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Vec3 p = points_m[i] - pose.centre_m;
    const Vec2 u = pixels[i] - pose.shift_px;
    const Eigen::Vector3d point(p.x, p.y, p.z);
    square += point * point.transpose();
    cross += Eigen::Vector2d(u.x, u.y) * point.transpose();
    spread_px2 += dot(u, u);
  }
  // A weak pull to the view from the front decides what flat shapes leave open.
  const double pull = 1e-6 * square.trace(), front = std::sqrt(spread_px2 / std::max(1e-300, square.trace()));
  Eigen::Matrix<double, 2, 3> from_front = Eigen::Matrix<double, 2, 3>::Zero();
  from_front(0, 0) = from_front(1, 1) = front;
  const Eigen::Matrix3d lifted = square + pull * Eigen::Matrix3d::Identity();
  const Eigen::Matrix<double, 2, 3> affine = linear::solve_ldlt(lifted, (cross + pull * from_front).transpose()).transpose();
  const linear::JacobiSvd<Eigen::MatrixXd> svd(affine, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::Matrix<double, 2, 3> rows = svd.matrixU() * svd.matrixV().transpose();
  pose.scale_px_per_m = svd.singularValues().mean();
  const Vec3 x{rows(0, 0), rows(0, 1), rows(0, 2)}, y{rows(1, 0), rows(1, 1), rows(1, 2)}, z = gonio::cross(x, y);
  pose.rotation = quaternion_of(Mat3{{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}});
  return pose;
}

std::vector<double> beyond_quadratic(std::span<const Vec3> points, std::span<const Vec2> pixels) {
  constexpr Eigen::Index terms = 10;
  const auto n = static_cast<Eigen::Index>(points.size());
  if (n < 16) return {};
  Eigen::MatrixXd a(n, terms), y(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 p = points[static_cast<std::size_t>(i)];
    const Vec2 u = pixels[static_cast<std::size_t>(i)];
    a.row(i) << 1, p.x, p.y, p.z, p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.x * p.z, p.y * p.z;
    y.row(i) << u.x, u.y;
  }
  for (Eigen::Index c = 0; c < terms; ++c) a.col(c) /= std::max(1e-300, a.col(c).norm());
  const Eigen::MatrixXd left =
      (y - a * linear::PivotedQr(a).solve(y)) * std::sqrt(static_cast<double>(n) / static_cast<double>(n - terms));
  return {left.data(), left.data() + left.size()};
}

}  // namespace gonio::explain::tables
