// See local_surface.h.
#include "explain/clouds/local_surface.h"

#include <algorithm>
#include <cmath>

#include "linear/geom_matrices.h"
#include "linear/positive.h"
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

std::array<double, 6> LocalSurface::terms(Vec3 point) const {
  const double a = dot(point - middle_, u_) / scale_, b = dot(point - middle_, v_) / scale_;
  return {1, a, b, a * a, a * b, b * b};
}

Vec2 LocalSurface::slope(Vec3 point) const {
  const auto t = terms(point);
  return Vec2{height_[1] + 2 * height_[3] * t[1] + height_[4] * t[2],
              height_[2] + height_[4] * t[1] + 2 * height_[5] * t[2]} *
         (1 / scale_);
}

double LocalSurface::off(Vec3 point) const {
  const auto t = terms(point);
  const Vec2 s = slope(point);
  double height = 0;
  for (std::size_t k = 0; k < t.size(); ++k) height += t[k] * height_[k];
  return (dot(point - middle_, normal_) - height) / std::sqrt(1 + s.x * s.x + s.y * s.y);
}

Vec3 LocalSurface::normal(Vec3 point) const {
  const Vec2 s = slope(point);
  return normalized(normal_ - s.x * u_ - s.y * v_);
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
  s.normal_ = normal_of(about, s.middle_);
  s.u_ = normalized(cross(s.normal_, std::abs(s.normal_.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  s.v_ = cross(s.normal_, s.u_), s.scale_ = norm(about.front()->position_m - s.middle_);
  std::array<double, 36> square{}, inverse{};
  std::array<double, 6> right{};
  for (const scan::ScanPoint* p : about) {
    const auto row = s.terms(p->position_m);
    const double height = dot(p->position_m - s.middle_, s.normal_);
    for (std::size_t i = 0; i < 6; ++i) {
      right[i] += height * row[i];
      for (std::size_t j = 0; j < 6; ++j) square[6 * i + j] += row[i] * row[j];
    }
  }
  if (!linear::positive_inverse<6>(square, inverse)) return std::nullopt;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) s.height_[i] += inverse[6 * i + j] * right[j];
  double squares = 0;
  for (const scan::ScanPoint* p : about) squares += s.off(p->position_m) * s.off(p->position_m) / count;
  if (!(squares <= roughest * roughest * s.scale_ * s.scale_)) return std::nullopt;
  return s;
}

}  // namespace gonio::explain
