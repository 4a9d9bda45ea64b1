// The lens map's derivatives in closed form, and where its radial part stops being one-to-one.
#include "camera/lens_terms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace gonio::camera {
namespace {

using L = LensTerm;

// R and its derivatives; w = r^2.
struct Radial {
  double above = 1, below = 1, value = 1, by_w = 0;
};

Radial radial_of(const double* c, double w) {
  const double f = c[L::fisheye];
  Radial r;
  r.above = 1 + w * (c[L::k1] + w * (c[L::k2] + w * (c[L::k3] + w * (f * c[L::k4]))));
  r.below = 1 + (1 - f) * (w * (c[L::k4] + w * (c[L::k5] + w * c[L::k6])));
  r.value = r.above / r.below;
  const double above_w = c[L::k1] + w * (2 * c[L::k2] + w * (3 * c[L::k3] + w * 4 * f * c[L::k4]));
  const double below_w = (1 - f) * (c[L::k4] + w * (2 * c[L::k5] + w * 3 * c[L::k6]));
  r.by_w = (above_w - r.value * below_w) / r.below;
  return r;
}

std::array<double, 4> jacobian(const double* c, const Radial& radial, double x, double y) {
  const double r2 = x * x + y * y;
  const double prism_x = c[L::s1] + 2 * r2 * c[L::s2], prism_y = c[L::s3] + 2 * r2 * c[L::s4];
  const double mixed = 2 * x * y * radial.by_w + 2 * c[L::p1] * x + 2 * c[L::p2] * y;
  return {radial.value + 2 * x * x * radial.by_w + 2 * c[L::p1] * y + 6 * c[L::p2] * x + 2 * x * prism_x,
          mixed + 2 * y * prism_x, mixed + 2 * x * prism_y,
          radial.value + 2 * y * y * radial.by_w + 6 * c[L::p1] * y + 2 * c[L::p2] * x + 2 * y * prism_y};
}

// The plane's place (x, y) = h (X, Y) of a direction, with d h / d(X, Y, Z) = [X, Y, Z] parts and d h / d fisheye.
struct Plane {
  double x = 0, y = 0;
  double h = 0, by_across = 0, by_z = 0, by_fisheye = 0;  // d h = by_across (X dX + Y dY) + by_z dZ + ...
};

bool perspective_plane(Vec3 p, Plane& plane) {
  if (!(p.z > 0)) return false;
  plane.x = p.x / p.z;
  plane.y = p.y / p.z;
  const double t2 = plane.x * plane.x + plane.y * plane.y, t = std::sqrt(t2);
  plane.h = 1 / p.z;
  plane.by_z = -plane.h * plane.h;
  plane.by_fisheye = plane.h * (t2 < 1e-8 ? -2.0 / 3 * t2 : 1 - std::atan(t) * (1 + t2) / t);
  return true;
}

// Near the axis, by the series of h Z in t^2 = tan^2 theta.
void near_axis_plane(double l, Vec3 p, Plane& plane) {
  const double z2 = p.z * p.z, t2 = (p.x * p.x + p.y * p.y) / z2, l2 = l * l;
  const double a = (l2 - 1) / 3, b = 0.2 - l2 / 3 + 2.0 / 15 * l2 * l2;
  const double series = 1 + t2 * (a + t2 * b), slope = a + 2 * t2 * b;  // d series / d t^2
  plane.h = series / p.z;
  plane.by_across = 2 * slope / (z2 * p.z);
  plane.by_z = -(series + 2 * t2 * slope) / z2;
  plane.by_fisheye = -t2 * (2 * l / 3 + t2 * (-2 * l / 3 + 8.0 / 15 * l2 * l)) / p.z;
}

bool family_plane(double fisheye, Vec3 p, Plane& plane) {
  const double l = 1 - fisheye, across2 = p.x * p.x + p.y * p.y;
  if (p.z > 0 && across2 < 3e-5 * p.z * p.z) {
    near_axis_plane(l, p, plane);
  } else {
    if (!(across2 > 0)) return false;
    const double across = std::sqrt(across2), squared = across2 + p.z * p.z;
    const double theta = std::atan2(across, p.z), angle = l * theta, a2 = angle * angle;
    if (!(angle < 1.57)) return false;
    const double r = angle < 0.01 ? theta * (1 + a2 * (1.0 / 3 + a2 * (2.0 / 15))) : std::tan(angle) / l;
    const double by_theta = 1 + l * l * r * r;
    const double by_l = angle < 0.01 ? theta * theta * angle * (2.0 / 3 + a2 * (8.0 / 15)) : (theta * by_theta - r) / l;
    plane.h = r / across;
    plane.by_across = (by_theta * p.z / squared - plane.h) / across2;
    plane.by_z = -by_theta / squared;
    plane.by_fisheye = -by_l / across;
  }
  plane.x = plane.h * p.x;
  plane.y = plane.h * p.y;
  return true;
}

// Real roots in (0, end) of the polynomial with coefficients from the constant upwards: between the extrema, found by
// the same means, the polynomial is monotonic, and bisection is exact to the last bit and cannot cycle.
std::vector<double> positive_roots(const std::vector<double>& p, double end) {
  std::vector<double> slope;
  for (std::size_t i = 1; i < p.size(); ++i) slope.push_back(static_cast<double>(i) * p[i]);
  while (!slope.empty() && slope.back() == 0) slope.pop_back();
  if (slope.empty()) return {};
  const auto value = [&](double x) {
    double sum = 0;
    for (std::size_t i = p.size(); i-- > 0;) sum = sum * x + p[i];
    return sum;
  };
  std::vector<double> knots = positive_roots(slope, end), roots;
  knots.push_back(end);
  double low = 0;
  for (const double knot : knots) {
    const bool below = value(low) < 0;
    if (value(low) != 0 && (value(knot) < 0) != below) {
      double a = low, b = knot;
      while (true) {
        const double middle = 0.5 * (a + b);
        if (middle <= a || middle >= b) break;
        ((value(middle) < 0) == below ? a : b) = middle;
      }
      roots.push_back(a);
    }
    low = knot;
  }
  return roots;
}

}  // namespace

std::array<double, 4> distortion_jacobian(const double* c, double x, double y) {
  return jacobian(c, radial_of(c, x * x + y * y), x, y);
}

bool lens_map_derivatives(const double* c, Vec3 p, LensMap& map) {
  Plane plane;
  if (!(c[L::fisheye] == 0 ? perspective_plane(p, plane) : family_plane(c[L::fisheye], p, plane))) return false;
  const double x = plane.x, y = plane.y, w = x * x + y * y, f = c[L::fisheye];
  distort(c, x, y, &map.x, &map.y);
  const Radial radial = radial_of(c, w);
  const std::array<double, 4> j = jacobian(c, radial, x, y);
  const std::array<double, 3> d_h{plane.by_across * p.x, plane.by_across * p.y, plane.by_z};
  const double inverse = 1 / radial.below, share = (1 - f) * radial.value;
  const std::array<double, 8> radial_by_term{w * inverse,
                                             w * w * inverse,
                                             0,
                                             0,
                                             w * w * w * inverse,
                                             (f * w * w * w * w - share * w) * inverse,
                                             -share * w * w * inverse,
                                             -share * w * w * w * inverse};
  const double k = c[L::k4];
  const double radial_by_fisheye =
      (k * w * w * w * w + radial.value * (w * (k + w * (c[L::k5] + w * c[L::k6])))) * inverse;
  for (std::size_t row = 0; row < 2; ++row) {
    const double jx = j[2 * row], jy = j[2 * row + 1], own = row == 0 ? x : y;
    const double along = jx * p.x + jy * p.y;
    for (std::size_t i = 0; i < 3; ++i) map.by_direction[row][i] = along * d_h[i];
    map.by_direction[row][0] += jx * plane.h;
    map.by_direction[row][1] += jy * plane.h;
    auto& by = map.by_term[row];
    for (std::size_t i = 0; i < radial_by_term.size(); ++i) by[i] = own * radial_by_term[i];
    by[L::p1] = row == 0 ? 2 * x * y : w + 2 * y * y;
    by[L::p2] = row == 0 ? w + 2 * x * x : 2 * x * y;
    by[L::s1] = row == 0 ? w : 0;
    by[L::s2] = row == 0 ? w * w : 0;
    by[L::s3] = row == 0 ? 0 : w;
    by[L::s4] = row == 0 ? 0 : w * w;
    by[L::fisheye] = along * plane.by_fisheye + own * radial_by_fisheye;
  }
  return true;
}

double angle_of_radius(double fisheye, double r) {
  const double l = 1 - fisheye, scaled = l * r;
  if (scaled < 1e-3) return r * (1 - scaled * scaled * (1.0 / 3 - scaled * scaled * 0.2));
  return std::atan(scaled) / l;
}

// With N / D for R and w = r^2, d(r R) / dr has the sign of (N + 2 w N') D - 2 w N D' up to the pole of R, D = 0.
double one_to_one_radius(const double* c) {
  constexpr double end = 1e12;  // r = 10^6: a ray 0.2 arc seconds from the image plane
  const double f = c[L::fisheye];
  const std::vector<double> n{1, c[L::k1], c[L::k2], c[L::k3], f * c[L::k4]};
  const std::vector<double> d{1, (1 - f) * c[L::k4], (1 - f) * c[L::k5], (1 - f) * c[L::k6]};
  std::vector<double> slope(n.size() + d.size() - 1);
  for (std::size_t i = 0; i < n.size(); ++i) {
    for (std::size_t j = 0; j < d.size(); ++j) {
      slope[i + j] += n[i] * d[j] * (1 + 2 * static_cast<double>(i) - 2 * static_cast<double>(j));
    }
  }
  double limit = std::numeric_limits<double>::infinity();
  for (const auto& polynomial : {slope, d}) {
    const std::vector<double> roots = positive_roots(polynomial, end);
    if (!roots.empty()) limit = std::min(limit, std::sqrt(roots.front()));
  }
  if (f == 0) return limit;
  const double l = 1 - f, widest = l * std::numbers::pi;
  if (widest < 1.57) limit = std::min(limit, l * std::numbers::pi < 1e-3 ? std::numbers::pi : std::tan(widest) / l);
  return limit;
}

}  // namespace gonio::camera
