// Refraction at a plane before the lens: camera.flat-port. Camera frame, metres; what lies beyond the plane lies in the
// other medium (an object in a tank, seen from outside, or from a housing whose window is thin).
//
// The plane N . X = d has the unit normal N along (tan tilt_x, tan tilt_y, 1). A point X beyond it has the depth
// z = N . X along the normal, the part P = X - z N across it, and h = |P|. Light leaves the plane at rho P + d N, where
// Snell's law, divided by h so that it holds on the axis as well, is
//   rho / sqrt(rho^2 h^2 + d^2) = index (1 - rho) / sqrt((1 - rho)^2 h^2 + (z - d)^2),
// whose left side grows with rho from 0 while the right one falls to 0 at rho = 1: one root. The lens sees X where it
// would see rho P + d N without the plane.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "geom/vector.h"

namespace gonio::equation {

struct FlatPort {
  double index = 1;  // of what lies beyond, over that of what the camera stands in; 1: nothing happens
  double distance_m = 0, tilt_x_rad = 0, tilt_y_rad = 0;
  bool operator==(const FlatPort&) const = default;
  bool refracts() const { return index != 1; }
  Vec3 normal() const { return normalized(Vec3{std::tan(tilt_x_rad), std::tan(tilt_y_rad), 1}); }
};

// The root above and what it is made of. `beyond` is false for points on the camera's side, which are seen as they are.
struct FlatPortCrossing {
  bool beyond = false;
  Vec3 normal, across;
  double depth_m = 0, h2 = 0, rho = 1;
};
inline FlatPortCrossing flat_port_crossing(const FlatPort& port, Vec3 point_m) {
  FlatPortCrossing c;
  c.normal = port.normal();
  c.depth_m = dot(c.normal, point_m);
  c.across = point_m - c.normal * c.depth_m;
  c.h2 = dot(c.across, c.across);
  const double d = port.distance_m, gap = c.depth_m - d;
  c.beyond = gap > 0 && d > 0;
  if (!c.beyond) return c;
  double low = 0, high = 1;
  double rho = port.index * d / (port.index * d + gap);  // the root near the axis
  for (int i = 0; i < 100; ++i) {
    const double a = rho * rho * c.h2 + d * d, s = 1 - rho, b = s * s * c.h2 + gap * gap;
    const double g = rho / std::sqrt(a) - port.index * s / std::sqrt(b);
    (g > 0 ? high : low) = rho;
    const double slope = d * d / (a * std::sqrt(a)) + port.index * gap * gap / (b * std::sqrt(b));
    const double step = g / slope;
    if (std::abs(step) < 1e-15) {  // before the bracket: at the root, whose one end it is, there is nothing to halve
      rho -= step;
      break;
    }
    rho = rho - step > low && rho - step < high ? rho - step : 0.5 * (low + high);
  }
  c.rho = rho;
  return c;
}
inline Vec3 flat_port_place(const FlatPort& port, const FlatPortCrossing& c) {
  return c.across * c.rho + c.normal * port.distance_m;
}

// Where the lens would see `point_m` without the plane.
inline Vec3 camera_flat_port(const FlatPort& port, Vec3 point_m) {
  if (!port.refracts()) return point_m;
  const FlatPortCrossing c = flat_port_crossing(port, point_m);
  return c.beyond ? flat_port_place(port, c) : point_m;
}

// d(seen point) by index, distance, tilt_x, tilt_y, and by the point's own coordinates. Where the index is one the seen
// point is the point itself, and only the index moves it.
struct FlatPortSlopes {
  std::array<Vec3, 4> by_port{};
  std::array<Vec3, 3> by_point{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
};
inline FlatPortSlopes camera_flat_port_slopes(const FlatPort& port, Vec3 point_m) {
  FlatPortSlopes result;
  const FlatPortCrossing c = flat_port_crossing(port, point_m);
  if (!c.beyond) return result;
  const double n = port.index, d = port.distance_m, gap = c.depth_m - d, rho = c.rho, s = 1 - rho;
  const double a = rho * rho * c.h2 + d * d, b = s * s * c.h2 + gap * gap, a3 = a * std::sqrt(a), b3 = b * std::sqrt(b);
  const double by_rho = d * d / a3 + n * gap * gap / b3;
  // of rho, by h^2, z, d and the index: -G_v / G_rho
  const double by_h2 = (rho * rho * rho / a3 - n * s * s * s / b3) / (2 * by_rho), by_z = -n * s * gap / (b3 * by_rho);
  if (!port.refracts()) {
    result.by_port[0] = c.across * (s / (std::sqrt(b) * by_rho) * c.depth_m / d);
    return result;
  }
  const double by_d = (rho * d / a3 + n * s * gap / b3) / by_rho, by_n = s / (std::sqrt(b) * by_rho);
  // h^2 = |X|^2 - z^2: how the seen point moves when X moves by dx and the normal by dn
  const auto moved = [&](Vec3 dx, Vec3 dn) {
    const double dz = dot(c.normal, dx) + dot(point_m, dn);
    const double dh2 = 2 * dot(point_m, dx) - 2 * c.depth_m * dz;
    return c.across * (by_h2 * dh2 + by_z * dz) + (dx - c.normal * dz - dn * c.depth_m) * rho + dn * d;
  };
  for (std::size_t k = 0; k < 3; ++k) result.by_point[k] = moved(result.by_point[k], {});
  result.by_port[0] = c.across * by_n;
  result.by_port[1] = c.across * by_d + c.normal;
  const double tx = std::tan(port.tilt_x_rad), ty = std::tan(port.tilt_y_rad);
  const double length = std::sqrt(tx * tx + ty * ty + 1);
  const std::array<Vec3, 2> raw{Vec3{1 + tx * tx, 0, 0}, Vec3{0, 1 + ty * ty, 0}};
  for (std::size_t k = 0; k < 2; ++k)
    result.by_port[2 + k] = moved({}, (raw[k] - c.normal * dot(c.normal, raw[k])) * (1 / length));
  return result;
}

// The ray in the other medium for a ray of the lens (unit direction); false where it never meets the plane or is
// reflected there wholly. It is refracted as if it came from the lens's centre, as points are: beside a moving pupil
// (lens.non-central) this is an approximation, and the same in both directions.
inline bool camera_flat_port_ray(const FlatPort& port, Vec3& origin_m, Vec3& direction) {
  const Vec3 normal = port.normal();
  const double along = dot(normal, direction);
  if (!(along > 0) || !(port.distance_m > 0)) return false;
  origin_m = origin_m + direction * ((port.distance_m - dot(normal, origin_m)) / along);
  const Vec3 met = normalized(origin_m);
  const Vec3 sine = (met - normal * dot(normal, met)) * (1 / port.index);
  const double left = 1 - dot(sine, sine);
  if (!(left > 0)) return false;
  direction = normalized(sine + normal * std::sqrt(left));
  return true;
}

}  // namespace gonio::equation
