// Distances of a sphere: d = |p - c| - R, so d(d) / dc = -(p - c) / |p - c| and d(d) / dR = -1. All sums are taken
// about the points' centroid, so that clouds far from the origin lose no digits.
#include "metrology/fitted_surface.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"
#include "metrology/rejection.h"

namespace gonio::metrology {
namespace {

using Matrix = Eigen::Matrix4d;
using Column = Eigen::Vector4d;

constexpr std::size_t fewest_points = 10, cells = 512;

void check_points(std::span<const Vec3> points_m, const std::string& place) {
  if (points_m.size() < fewest_points)
    throw Error(Exit::data, place, "has " + std::to_string(points_m.size()) + " points here, at least 10 are needed",
                "give a larger region or a denser cloud");
  for (const Vec3& p : points_m)
    if (!is_finite(p)) throw Error(Exit::data, place, "has a point that is not finite");
}

Vec3 mean_of(std::span<const Vec3> points, const std::vector<char>& counts) {
  Vec3 sum;
  double n = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (counts[i]) sum += points[i], n += 1;
  return sum / n;
}

[[noreturn]] void refuse_cap(const std::string& place, const std::string& why) {
  throw Error(Exit::data, place, "does not determine a sphere: " + why,
              "measure a larger part of it, or hold the calibrated radius (--hold-radius)");
}

// |q|^2 = 2 a q + b about the centroid (Coope 1993): c = a, R^2 = b + |a|^2.
Column algebraic_sphere(std::span<const Vec3> q, const std::vector<char>& counts, const std::string& place) {
  Matrix a = Matrix::Zero();
  Column b = Column::Zero();
  double scale2 = 0;
  for (const Vec3& p : q) scale2 = std::max(scale2, dot(p, p));
  const double scale = std::sqrt(scale2);
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (!counts[i]) continue;
    const Column row(2 * q[i].x / scale, 2 * q[i].y / scale, 2 * q[i].z / scale, 1);
    a += row * row.transpose();
    b += row * (dot(q[i], q[i]) / scale2);
  }
  const linear::SymmetricEigen<Matrix> eigen(a);
  if (!(eigen.eigenvalues()[0] > 1e-12 * eigen.eigenvalues()[3])) refuse_cap(place, "its points lie in a plane");
  const Column s = linear::solve_ldlt(a, b) * 1.0;
  const double radius2 = s[3] + s.head<3>().squaredNorm();
  return {s[0] * scale, s[1] * scale, s[2] * scale, scale * std::sqrt(std::max(radius2, 0.0))};
}

struct SphereSystem {
  Matrix normal = Matrix::Zero();
  Column gradient = Column::Zero();
};

Column derivative(const Vec3& q, const Column& s, double* distance) {
  const Vec3 d = q - Vec3{s[0], s[1], s[2]};
  const double r = norm(d);
  *distance = r - s[3];
  if (!(r > 0)) return {0, 0, 0, -1};
  return {-d.x / r, -d.y / r, -d.z / r, -1};
}

Column refined(std::span<const Vec3> q, const std::vector<char>& counts, Column s, bool held) {
  for (int step = 0; step < 50; ++step) {
    SphereSystem system;
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (!counts[i]) continue;
      double distance = 0;
      const Column j = derivative(q[i], s, &distance);
      system.normal += j * j.transpose();
      system.gradient += j * distance;
    }
    if (held) {
      system.normal.row(3).setZero();
      system.normal.col(3).setZero();
      system.normal(3, 3) = 1;
      system.gradient[3] = 0;
    }
    const Column move = linear::solve_ldlt(system.normal, system.gradient);
    if (!move.allFinite()) break;
    s -= move;
    if (move.norm() < 1e-13 * s[3]) break;
  }
  return s;
}

Matrix sphere_covariance(std::span<const Vec3> q, const std::vector<char>& counts, const Column& s, bool held) {
  const int parameters = held ? 3 : 4;
  const std::vector<std::uint32_t> cell = cells_of(q);
  std::vector<Column> score(cells, Column::Zero());
  std::vector<char> used(cells, 0);
  Matrix normal = Matrix::Zero();
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (!counts[i]) continue;
    double distance = 0;
    Column j = derivative(q[i], s, &distance);
    if (held) j[3] = 0;
    normal += j * j.transpose();
    score[cell[i]] += j * distance;
    used[cell[i]] = 1;
  }
  if (held) normal(3, 3) = 1;
  Matrix between = Matrix::Zero();
  for (const Column& c : score) between += c * c.transpose();
  const auto groups = static_cast<double>(std::ranges::count(used, 1));
  const Matrix inverse = normal.inverse();
  return inverse * between * inverse * (groups / std::max(1.0, groups - parameters));
}

}  // namespace

SphereFit fit_sphere(std::span<const Vec3> points_m, std::optional<double> held_radius_m, const std::string& place) {
  check_points(points_m, place);
  std::vector<char> counts(points_m.size(), 1);
  const Vec3 origin = mean_of(points_m, counts);
  std::vector<Vec3> q;
  for (const Vec3& p : points_m) q.push_back(p - origin);
  Column sphere = algebraic_sphere(q, counts, place);
  const auto fit = [&](const std::vector<char>& mask) {
    counts = mask;
    if (held_radius_m) sphere[3] = *held_radius_m;
    sphere = refined(q, counts, sphere, held_radius_m.has_value());
    std::vector<double> deviations(q.size());
    for (std::size_t i = 0; i < q.size(); ++i) derivative(q[i], sphere, &deviations[i]);
    return deviations;
  };
  const std::vector<std::size_t> out = reject_until_stable(q.size(), fit);
  SphereFit result;
  result.centre_m = origin + Vec3{sphere[0], sphere[1], sphere[2]};
  result.radius_m = sphere[3];
  const Matrix covariance = sphere_covariance(q, counts, sphere, held_radius_m.has_value());
  if (!covariance.allFinite() || !(result.radius_m > 0)) refuse_cap(place, "the fit does not settle");
  for (int i = 0; i < 16; ++i) result.covariance[static_cast<std::size_t>(i)] = covariance(i / 4, i % 4);
  if (!(result.radius_sigma_m() < 0.05 * result.radius_m))
    refuse_cap(place, "its radius is uncertain by more than 5 %");
  result.deviations = sorted_out(fit(counts), out);
  return result;
}

PlaneFit fit_plane(std::span<const Vec3> points_m, const std::string& place) {
  check_points(points_m, place);
  PlaneFit result;
  linear::SymmetricEigen<Eigen::Matrix3d> eigen;
  std::vector<char> counts;
  const auto fit = [&](const std::vector<char>& mask) {
    counts = mask;
    result.centroid_m = mean_of(points_m, counts);
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < points_m.size(); ++i) {
      if (!counts[i]) continue;
      const Vec3 d = points_m[i] - result.centroid_m;
      const Eigen::Vector3d e(d.x, d.y, d.z);
      scatter += e * e.transpose();
    }
    eigen = linear::SymmetricEigen<Eigen::Matrix3d>(scatter);
    const auto n = eigen.eigenvectors().col(0);
    result.normal = {n[0], n[1], n[2]};
    if (dot(result.normal, result.centroid_m) > 0) result.normal = -result.normal;
    std::vector<double> deviations;
    for (const Vec3& p : points_m) deviations.push_back(dot(p - result.centroid_m, result.normal));
    return deviations;
  };
  const std::vector<std::size_t> out = reject_until_stable(points_m.size(), fit);
  if (!(eigen.eigenvalues()[1] > 1e-9 * eigen.eigenvalues()[2]))
    throw Error(Exit::data, place, "does not determine a plane: its points lie in a line", "measure an area");
  const std::vector<double> deviations = fit(counts);
  const std::vector<std::uint32_t> cell = cells_of(points_m);
  std::vector<Eigen::Vector3d> score(cells, Eigen::Vector3d::Zero());
  double n = 0;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (!counts[i]) continue;
    const Vec3 d = points_m[i] - result.centroid_m;
    const Eigen::Vector3d e(d.x, d.y, d.z);
    const Eigen::Vector3d j(1, eigen.eigenvectors().col(2).dot(e), eigen.eigenvectors().col(1).dot(e));
    score[cell[i]] += j * deviations[i];
    n += 1;
  }
  Eigen::Vector3d between = Eigen::Vector3d::Zero();
  double groups = 0;
  for (const Eigen::Vector3d& s : score) {
    between += s.cwiseProduct(s);
    if (!s.isZero(0)) groups += 1;
  }
  between *= groups / std::max(1.0, groups - 3);
  result.offset_sigma_m = std::sqrt(between[0]) / n;
  result.tilt_sigma_rad = {std::sqrt(between[1]) / eigen.eigenvalues()[2],
                           std::sqrt(between[2]) / eigen.eigenvalues()[1]};
  result.deviations = sorted_out(deviations, out);
  return result;
}

}  // namespace gonio::metrology
