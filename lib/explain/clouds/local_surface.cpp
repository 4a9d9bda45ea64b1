// See local_surface.h.
#include "explain/clouds/local_surface.h"

#include <algorithm>
#include <cmath>

#include "linear/geom_matrices.h"
#include "linear/symmetric_eigen.h"

namespace gonio::explain {
namespace {

constexpr double fewest = 2.0 / 3;  // of the neighbours
constexpr double roughest = 0.1;    // root mean square off one smooth surface, over the way to the farthest neighbour

Vec3 normal_of(std::span<const scan::ScanPoint* const> points, Vec3 middle) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const scan::ScanPoint* p : points) {
    const Eigen::Vector3d v = linear::as_eigen(p->position_m - middle);
    scatter += v * v.transpose();
  }
  const Eigen::Vector3d n = linear::SymmetricEigen<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  const Vec3 normal{n.x(), n.y(), n.z()};
  return dot(normal, middle) > 0 ? -normal : normal;
}

}  // namespace

Vec3 LocalSurface::local(Vec3 point) const {
  return basis_.to_local(point - middle_) / scale_;
}

Vec2 LocalSurface::slope(Vec3 point) const {
  const Vec3 p = local(point);
  const mesh::LocalQuadratic::Terms& c = fit_.c;
  return {c[1] + 2 * c[3] * p.x + c[4] * p.y, c[2] + c[4] * p.x + 2 * c[5] * p.y};
}

double LocalSurface::off(Vec3 point) const {
  const Vec3 p = local(point);
  const Vec2 s = slope(point);
  return scale_ * (p.z - fit_.at(p.x, p.y)) / std::sqrt(1 + s.x * s.x + s.y * s.y);
}

Vec3 LocalSurface::normal(Vec3 point) const {
  const Vec2 s = slope(point);
  return normalized(basis_.to_world({-s.x, -s.y, 1}));
}

Vec3 LocalSurface::along(Vec3 point, Vec3 direction) const {
  for (int step = 0; step < 3; ++step) point += direction * (-off(point) / dot(normal(point), direction));
  return point;
}

std::optional<LocalSurface> LocalSurface::about(std::span<const scan::ScanPoint> points, const PointsByPixel& by_pixel,
                                                Vec2 pixel) {
  std::vector<const scan::ScanPoint*> about;
  const long x = std::lround(pixel.x), y = std::lround(pixel.y);
  LocalSurface s;
  for (long j = -local_reach; j <= local_reach; ++j)
    for (long i = -local_reach; i <= local_reach; ++i)
      if (const auto place = by_pixel.at(x + i, y + j)) {
        about.push_back(&points[*place]);
        s.middle_ += about.back()->position_m;
      }
  constexpr long side = 2 * local_reach + 1;
  const auto count = static_cast<double>(about.size());
  if (count < fewest * side * side) return std::nullopt;
  s.middle_ = s.middle_ * (1 / count);
  s.basis_ = Basis(normal_of(about, s.middle_)), s.scale_ = norm(about.front()->position_m - s.middle_);
  mesh::LocalQuadratic sums;
  for (const scan::ScanPoint* p : about) {
    const Vec3 at = s.local(p->position_m);
    sums.add(at.x, at.y, at.z);
  }
  s.fit_ = sums.fit();
  if (!s.fit_.good) return std::nullopt;
  double squares = 0;
  for (const scan::ScanPoint* p : about) squares += s.off(p->position_m) * s.off(p->position_m) / count;
  if (!(squares <= roughest * roughest * s.scale_ * s.scale_)) return std::nullopt;
  return s;
}

}  // namespace gonio::explain
