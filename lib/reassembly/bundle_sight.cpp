// Residuals of sightings, and the point on which several agree (Gauss-Newton from the point nearest to all rays).
#include "reassembly/bundle_sight.h"

#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "linear/geom_matrices.h"
#include "linear/positive.h"

namespace gonio::reassembly {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;

// The point nearest to all rays, by squared distance; nothing where they are parallel.
std::optional<Vector3d> nearest_point(std::span<const Sight* const> sights) {
  Matrix3d n = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  for (const Sight* s : sights) {
    const Matrix3d across = Matrix3d::Identity() - s->axis * s->axis.transpose();
    n += across;
    b += across * s->origin;
  }
  std::array<double, 9> a, inverse;
  Eigen::Map<Matrix3d>(a.data()) = n;
  if (!linear::positive_inverse<3>(a, inverse, 1e-10)) return {};
  return Vector3d(Eigen::Map<const Matrix3d>(inverse.data()) * b);
}

double seen_radius(std::span<const Sight* const> sights, const Vector3d& point) {
  double sum = 0, count = 0;
  for (const Sight* s : sights)
    if (s->sized) sum += (point - s->origin).norm() * std::sin(s->half_angle), ++count;
  return count > 0 ? sum / count : 0;
}

struct MeetingNormal {
  Matrix4d h = Matrix4d::Zero();
  Vector4d downhill = Vector4d::Zero();
  double chi_square = 0;
};
// Of point and radius; false where a sight has no value there.
bool normal_at(std::span<const Sight* const> sights, const Vector3d& point, double radius, bool free_radius,
               MeetingNormal& normal) {
  normal = {};
  for (const Sight* s : sights) {
    Misfit m;
    if (!misfit(*s, point, radius, m)) return false;
    Matrix3d all = s->covariance;
    if (!s->firm) all += m.by_pose * s->pose * m.by_pose.transpose();
    const Matrix3d white = lower_inverse(lower_root(all));
    const Vector3d r = white * m.r;
    Eigen::Matrix<double, 3, 4> j;
    j.leftCols<3>() = white * m.by_point;
    if (free_radius)
      j.col(3) = white * m.by_radius;
    else
      j.col(3).setZero();
    const Vector3d weight(1, 1, s->sized ? size_weight(r[2]) : 0);
    normal.h += j.transpose() * weight.asDiagonal() * j;
    normal.downhill -= j.transpose() * weight.cwiseProduct(r);
    normal.chi_square += r.head<2>().squaredNorm() + (s->sized ? size_cost(r[2]) : 0);
  }
  if (!free_radius) normal.h(3, 3) = 1;
  return true;
}

}  // namespace

Matrix3d lower_root(const Matrix3d& a) {
  Matrix3d l = Matrix3d::Zero();
  l(0, 0) = std::sqrt(a(0, 0));
  l(1, 0) = a(1, 0) / l(0, 0);
  l(2, 0) = a(2, 0) / l(0, 0);
  l(1, 1) = std::sqrt(a(1, 1) - l(1, 0) * l(1, 0));
  l(2, 1) = (a(2, 1) - l(2, 0) * l(1, 0)) / l(1, 1);
  l(2, 2) = std::sqrt(a(2, 2) - l(2, 0) * l(2, 0) - l(2, 1) * l(2, 1));
  return l;
}

Matrix3d lower_inverse(const Matrix3d& l) {
  Matrix3d m = Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) m(i, i) = 1 / l(i, i);
  m(1, 0) = -l(1, 0) * m(0, 0) * m(1, 1);
  m(2, 1) = -l(2, 1) * m(1, 1) * m(2, 2);
  m(2, 0) = -(l(2, 0) * m(0, 0) + l(2, 1) * m(1, 0)) * m(2, 2);
  return m;
}

double size_weight(double whitened) {
  return std::abs(whitened) > size_width ? size_width / std::abs(whitened) : 1;
}
double size_cost(double whitened) {
  const double a = std::abs(whitened);
  return a > size_width ? size_width * (2 * a - size_width) : a * a;
}

Sight sight_of(const View& view, const Outline& outline, const std::string& place) {
  Sight s;
  s.origin = linear::as_eigen(view.world_from_camera.translation_m);
  const Vec3 axis = normalized(outline.axis), across = across_of(axis);
  s.axis = linear::as_eigen(view.world_from_camera.rotate(axis));
  s.across = linear::as_eigen(view.world_from_camera.rotate(across));
  s.down = linear::as_eigen(view.world_from_camera.rotate(cross(axis, across)));
  s.half_angle = outline.half_angle_rad;
  s.covariance = linear::as_eigen(outline.covariance_rad2);
  s.sized = outline.half_angle_rad > 0 && s.covariance(2, 2) > 0;
  if (!s.sized) {
    s.covariance.row(2).setZero();
    s.covariance.col(2).setZero();
    s.covariance(2, 2) = 1;
  }
  s.pose = Eigen::Map<const Matrix6>(view.covariance.data());
  s.firm = s.pose.isZero(0);
  s.px_per_rad = outline.half_angle_rad > 0 ? outline.radius_px / outline.half_angle_rad : 0;
  if (!lower_root(s.covariance).allFinite() || s.covariance.diagonal().minCoeff() <= 0)
    throw Error(Exit::data, place,
                format("an outline's covariance is not positive definite (variances %g %g %g rad^2)",
                       s.covariance(0, 0), s.covariance(1, 1), s.covariance(2, 2)),
                "give each outline the uncertainty of its fit");
  if (!s.axis.allFinite() || !s.origin.allFinite() || !s.pose.allFinite())
    throw Error(Exit::data, place, "an axis, a pose or its covariance is not finite", "leave this view out");
  return s;
}

Sight moved(Sight s, const Eigen::Matrix<double, 6, 1>& motion) {
  const Vector3d w = motion.head<3>();
  const Matrix3d turn = linear::as_eigen(matrix_of(quaternion_of_rotation_vector({w.x(), w.y(), w.z()})));
  s.axis = turn * s.axis;
  s.across = turn * s.across;
  s.down = turn * s.down;
  s.origin += motion.tail<3>();
  return s;
}

bool misfit(const Sight& s, const Vector3d& point, double radius, Misfit& out) {
  const Vector3d p = point - s.origin;
  const double depth = p.dot(s.axis), d = p.norm();
  if (!(depth > 0) || !(radius < d)) return false;
  const double x = p.dot(s.across) / depth, y = p.dot(s.down) / depth;
  out.r = {x, y, 0};
  out.by_point.row(0) = (s.across - x * s.axis).transpose() / depth;
  out.by_point.row(1) = (s.down - y * s.axis).transpose() / depth;
  out.by_point.row(2).setZero();
  out.by_radius.setZero();
  if (s.sized && radius > 0) {
    const double h = std::asin(radius / d);
    out.r[2] = h - s.half_angle;
    out.by_point.row(2) = -std::tan(h) / (d * d) * p.transpose();
    out.by_radius[2] = 1 / (d * std::cos(h));
  }
  // The camera's motion is the point's, the other way round: p - omega x p - tau.
  out.by_pose.leftCols<3>() = out.by_point * linear::cross_matrix(p);
  out.by_pose.rightCols<3>() = -out.by_point;
  return true;
}

std::optional<Meeting> meet(std::span<const Sight* const> sights, std::optional<double> radius,
                            std::optional<Vector3d> start) {
  if (!start) start = nearest_point(sights);
  if (!start) return {};
  Meeting m;
  m.centre = *start;
  int sizes = 0;
  for (const Sight* s : sights) sizes += s->sized;
  const bool free_radius = !radius && sizes > 0;
  m.radius = radius ? *radius : seen_radius(sights, m.centre);
  m.sized = radius || free_radius;
  std::array<double, 16> inverse{};
  for (int step = 0; step < 20; ++step) {
    MeetingNormal normal;
    if (!normal_at(sights, m.centre, m.radius, free_radius, normal)) return {};
    std::array<double, 16> h;
    Eigen::Map<Matrix4d>(h.data()) = normal.h;
    if (!linear::positive_inverse<4>(h, inverse)) return {};
    m.chi_square = normal.chi_square;
    const Vector4d change = Eigen::Map<const Matrix4d>(inverse.data()) * normal.downhill;
    if (change.dot(normal.downhill) < 1e-8) break;
    m.centre += change.head<3>();
    m.radius += change[3];
    if (free_radius && m.radius <= 0) return {};
  }
  m.covariance = Eigen::Map<const Matrix4d>(inverse.data()).topLeftCorner<3, 3>();
  m.radius_variance = free_radius ? inverse[15] : 0;
  m.degrees = 2 * static_cast<int>(sights.size()) - 3 + sizes - (free_radius ? 1 : 0);
  // Rays that are parallel within their uncertainty say nothing of the distance.
  const double far = (m.centre - sights.front()->origin).squaredNorm();
  if (!(m.covariance.trace() < 0.04 * far)) return {};
  return m;
}

}  // namespace gonio::reassembly
