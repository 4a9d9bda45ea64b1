// See axis_rows.h.
#include "robot/axis_rows.h"

#include <cmath>

namespace gonio::robot {
namespace {

constexpr double parallel_rad = 1.5e-8;
constexpr double on_one_line = 1e-12;  // m

struct DhFrame {  // before a link: z along its axis
  Vec3 origin_m, x, z;
};

double angle_about_axis(Vec3 axis, Vec3 from, Vec3 to) {
  return std::atan2(dot(cross(from, to), axis), dot(from, to));
}

Mat3 rotation_of(const DhFrame& f) {
  const Vec3 y = cross(f.z, f.x);
  return {{f.x.x, y.x, f.z.x, f.x.y, y.y, f.z.y, f.x.z, y.z, f.z.z}};
}

DhFrame first_frame(const AxisLine& axis) {
  const Vec3 z = normalized(axis.direction);
  const Vec3 nearest = axis.through_m - z * dot(z, axis.through_m);  // to the base's origin
  if (z.z > 1 - 1e-15 && norm(nearest) < on_one_line) return {{}, {1, 0, 0}, {0, 0, 1}};
  const Vec3 along = std::abs(z.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
  return {nearest, normalized(along - z * dot(z, along)), z};
}

struct Normal {
  Vec3 from_m, to_m, direction;  // its feet, from axis to axis
};

Normal normal_between(const DhFrame& frame, const AxisLine& next, Vec3 x_if_free) {
  const Vec3 z = frame.z, w = next.direction, apart = next.through_m - frame.origin_m, c = cross(z, w);
  const double square = dot(c, c);
  if (square < parallel_rad * parallel_rad) {
    const Vec3 across = apart - z * dot(z, apart);
    const double distance = norm(across);
    if (distance < on_one_line) return {frame.origin_m, frame.origin_m, x_if_free};
    return {frame.origin_m, frame.origin_m + across, across / distance};
  }
  const Vec3 from = frame.origin_m + z * (dot(cross(apart, w), c) / square);
  const Vec3 to = next.through_m + w * (dot(cross(apart, z), c) / square);
  Vec3 x = c / std::sqrt(square);
  const double a = dot(to - from, x);
  // From axis to axis; where they meet, the sense that turns x less.
  if (std::abs(a) > on_one_line ? a < 0 : dot(x, frame.x) < -1e-9) x = -x;
  return {from, to, x};
}

}  // namespace

ChainRows rows_of(std::span<const AxisLine> axes, const Rigid<frame::Base, frame::Tool>& flange_at_zero) {
  ChainRows rows;
  DhFrame frame = first_frame(axes.front());
  rows.base_from_first = {quaternion_of(rotation_of(frame)), frame.origin_m};
  const Vec3 end = flange_at_zero.translation_m, end_z = flange_at_zero.rotate({0, 0, 1});
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const bool last = i + 1 == axes.size();
    const AxisLine next =
        last ? AxisLine{end_z, end} : AxisLine{normalized(axes[i + 1].direction), axes[i + 1].through_m};
    // On one line with axis 6 the flange's own x is as good as any, and its own height: nothing is left over.
    Vec3 free = last ? flange_at_zero.rotate({1, 0, 0}) : frame.x;
    free = normalized(free - frame.z * dot(frame.z, free));
    Normal normal = normal_between(frame, next, free);
    if (last && normal.from_m == normal.to_m && norm(cross(frame.z, end_z)) < parallel_rad)
      normal.from_m = normal.to_m = frame.origin_m + frame.z * dot(frame.z, end - frame.origin_m);
    Link link;
    link.theta_rad = angle_about_axis(frame.z, frame.x, normal.direction);
    link.d_m = dot(normal.from_m - frame.origin_m, frame.z);
    link.a_m = dot(normal.to_m - normal.from_m, normal.direction);
    link.alpha_rad = angle_about_axis(normal.direction, frame.z, next.direction);
    rows.links.push_back(link);
    frame = {normal.to_m, normal.direction, next.direction};
    frame.x = normalized(frame.x - frame.z * dot(frame.z, frame.x));
  }
  const Rigid<frame::Base, frame::Tool> stands{quaternion_of(rotation_of(frame)), frame.origin_m};
  rows.last_from_flange = inverse(stands) * flange_at_zero;
  return rows;
}

}  // namespace gonio::robot
