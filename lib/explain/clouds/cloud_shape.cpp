// See cloud_shape.h.
#include "explain/clouds/cloud_shape.h"

#include <array>
#include <cmath>

#include "metrology/fitted_surface.h"

namespace gonio::explain {
namespace {

using Freedom = CloudShape::Freedom;
constexpr std::array<Freedom, 3> of_plane{{{"distance_m", "m", 1e-3}, {"tilt_1", "1", 1e-3}, {"tilt_2", "1", 1e-3}}};
constexpr std::array<Freedom, 3> of_ball{{{"x_m", "m", 1e-3}, {"y_m", "m", 1e-3}, {"z_m", "m", 1e-3}}};
constexpr std::array<Freedom, 6> of_a_mesh{{{"turn_x_rad", "rad", 1e-3},
                                            {"turn_y_rad", "rad", 1e-3},
                                            {"turn_z_rad", "rad", 1e-3},
                                            {"x_m", "m", 1e-3},
                                            {"y_m", "m", 1e-3},
                                            {"z_m", "m", 1e-3}}};

}  // namespace

CloudShape CloudShape::plane(std::span<const Vec3> points_m, const std::string& place) {
  const metrology::PlaneFit fit = metrology::fit_plane(points_m, place);
  CloudShape s;
  s.middle_ = fit.centroid_m, s.normal_ = fit.normal;
  const Vec3 aside = std::abs(fit.normal.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  s.along_ = normalized(cross(fit.normal, aside)), s.across_ = cross(fit.normal, s.along_);
  return s;
}

CloudShape CloudShape::ball(std::span<const Vec3> points_m, double radius_m, const std::string& place) {
  CloudShape s;
  s.kind_ = Kind::ball, s.radius_m_ = radius_m;
  s.middle_ = metrology::fit_sphere(points_m, radius_m, place).centre_m;
  return s;
}

CloudShape CloudShape::of_mesh(std::shared_ptr<const ShapeMesh> mesh, const Rigid<frame::Rig, frame::Object>& pose) {
  CloudShape s;
  s.kind_ = Kind::mesh, s.mesh_ = std::move(mesh), s.pose_ = pose;
  Vec3 sum;
  for (const Vec3& p : s.mesh_->positions_m()) sum += p;
  s.middle_ = pose * (sum * (1 / static_cast<double>(s.mesh_->positions_m().size())));
  return s;
}

CloudShape CloudShape::patch(Vec3 at_m, Vec3 normal, Vec3 pivot_m) {
  CloudShape s;
  s.kind_ = Kind::patch, s.at_ = at_m, s.normal_ = normal, s.middle_ = pivot_m;
  return s;
}

std::span<const Freedom> CloudShape::freedoms() const {
  switch (kind_) {
    case Kind::plane: return of_plane;
    case Kind::ball: return of_ball;
    case Kind::mesh:
    case Kind::patch: return of_a_mesh;
  }
  return {};
}

std::optional<CloudShape::Met> CloudShape::met(Vec3 origin, Vec3 direction, std::span<const double> change) const {
  if (kind_ == Kind::plane) {
    const Vec3 normal = normalized(normal_ + change[1] * along_ + change[2] * across_);
    const double against = dot(normal, direction),
                 distance = dot(middle_ + change[0] * normal_ - origin, normal) / against;
    if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
    return Met{distance, against < 0 ? normal : -normal};
  }
  if (kind_ == Kind::ball) {
    const Vec3 from = origin - middle_ - Vec3{change[0], change[1], change[2]};
    const double b = dot(from, direction), root = b * b - dot(from, from) + radius_m_ * radius_m_;
    if (!(root > 0)) return std::nullopt;
    const double distance = -b - std::sqrt(root);
    if (!(distance > 0)) return std::nullopt;
    return Met{distance, (from + distance * direction) * (1 / radius_m_)};
  }
  if (kind_ == Kind::patch) {
    const Mat3 turn = matrix_of(quaternion_of_rotation_vector({change[0], change[1], change[2]}));
    const Vec3 normal = turn * normal_, at = middle_ + turn * (at_ - middle_) + Vec3{change[3], change[4], change[5]};
    const double against = dot(normal, direction), distance = dot(at - origin, normal) / against;
    if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
    return Met{distance, against < 0 ? normal : -normal};
  }
  // The mesh turned about its middle: the ray goes to its frame.
  const Quaternion back = conjugate(quaternion_of_rotation_vector({change[0], change[1], change[2]}));
  const Mat3 turn = matrix_of(back);
  const Vec3 shift{change[3], change[4], change[5]};
  const Rigid<frame::Object, frame::Rig> object_from_rig = inverse(pose_);
  const Vec3 o = object_from_rig * (middle_ + turn * (origin - middle_ - shift)),
             d = object_from_rig.rotate(turn * direction);
  const auto hit = mesh_->tree().first_hit(o, d, 1e-9);
  if (!hit) return std::nullopt;
  const auto& t = mesh_->triangles()[hit->triangle];
  const Vec3 a = mesh_->positions_m()[t[0]], b = mesh_->positions_m()[t[1]], c = mesh_->positions_m()[t[2]];
  Vec3 n = normalized(cross(b - a, c - a));
  if (dot(n, d) > 0) n = -n;
  return Met{hit->t, transposed(turn) * pose_.rotate(n)};
}

double CloudShape::off(Vec3 point) const {
  if (kind_ == Kind::plane) return dot(point - middle_, normal_);
  if (kind_ == Kind::patch) return dot(point - at_, normal_);
  if (kind_ == Kind::ball) return norm(point - middle_) - radius_m_;
  return mesh_->tree().nearest(inverse(pose_) * point).distance_m;
}

}  // namespace gonio::explain
