// The lens as a map from a direction (X, Y, Z) in the camera frame (x right, y down, z forward) to distorted
// normalised coordinates (x', y'), from which pixels follow as fx x' + cx, fy y' + cy. First the direction is laid on a
// plane,
//
//   (x, y) = r (X, Y) / |(X, Y)|,   r = tan(L theta) / L,   theta = atan2(|(X, Y)|, Z),   L = 1 - fisheye,
//
// Gennery's family ("Generalized camera calibration including fish-eye lenses", IJCV 68(3), 2006, section 3), which
// runs from the perspective view (fisheye = 0: x = X / Z, y = Y / Z) to the equidistant one (fisheye = 1: r = theta);
// then
//
//   x' = x R + 2 p1 x y + p2 (r^2 + 2 x^2) + s1 r^2 + s2 r^4          1 + k1 r^2 + k2 r^4 + k3 r^6 + fisheye k4 r^8
//   y' = y R + p1 (r^2 + 2 y^2) + 2 p2 x y + s3 r^2 + s4 r^4     R = ------------------------------------------------
//                                                                    1 + (1 - fisheye) (k4 r^2 + k5 r^4 + k6 r^6)
//
// At fisheye = 0 this is OpenCV's perspective lens: Brown, "Close-range camera calibration", Photogrammetric
// Engineering 37(8), 1971, eq. 9; thin prism of Weng, Cohen & Herniou, PAMI 14(10), 1992, eq. 13; k4 k5 k6 in the
// denominator. At fisheye = 1 it is the polynomial of Kannala & Brandt, PAMI 28(8), 2006, eq. 6, as in OpenCV's
// cv::fisheye, in which k4 is the fourth coefficient; in between one fades into the other, so that a fit can pass.
//
// The equations are templates over the scalar, for whoever differentiates by dual numbers; lens_map_derivatives has the
// same in closed form. The mechanisms lens.* (mechanisms/) name the coefficients. Invariant: a term whose coefficients
// are zero leaves the result bit-identical. Does not invert the map (camera_model.h).
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "geom/vector.h"

namespace gonio::camera {

inline constexpr std::size_t distortion_terms = 13;
inline constexpr std::array<std::string_view, distortion_terms> distortion_names = {
    "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "fisheye"};  // OpenCV's order, then our own

struct LensTerm {  // places in distortion_names
  static constexpr std::size_t k1 = 0, k2 = 1, p1 = 2, p2 = 3, k3 = 4, k4 = 5, k5 = 6, k6 = 7;
  static constexpr std::size_t s1 = 8, s2 = 9, s3 = 10, s4 = 11, fisheye = 12;
};

// The direction laid on the plane; false where it has no place there (behind a perspective camera).
template <class T>
bool lay_on_plane(const T& fisheye, const T* direction, T* x, T* y) {
  using std::atan2;
  using std::sqrt;
  using std::tan;
  const T &px = direction[0], &py = direction[1], &pz = direction[2];
  if (fisheye == T(0)) {
    if (!(pz > T(0))) return false;
    *x = px / pz;
    *y = py / pz;
    // To first order in fisheye, whose value is zero here: d(r / tan theta) / d fisheye = 1 - theta / (sin cos theta).
    const T t2 = *x * *x + *y * *y;
    const T t = sqrt(t2 + T(1e-300));
    const T slope = t2 < T(1e-8) ? T(-2.0 / 3) * t2 : T(1) - atan2(t, T(1)) * (T(1) + t2) / t;
    const T factor = T(1) + fisheye * slope;
    *x = *x * factor;
    *y = *y * factor;
    return true;
  }
  const T l = T(1) - fisheye;
  const T across2 = px * px + py * py;
  if (pz > T(0) && across2 < T(3e-5) * pz * pz) {  // the family's series in tan^2 theta
    const T t2 = across2 / (pz * pz), l2 = l * l;
    const T h = T(1) + t2 * ((l2 - T(1)) / T(3) + t2 * (T(0.2) - l2 / T(3) + T(2.0 / 15) * l2 * l2));
    *x = px / pz * h;
    *y = py / pz * h;
    return true;
  }
  if (!(across2 > T(0))) return false;  // straight behind
  const T across = sqrt(across2);
  const T theta = atan2(across, pz);
  const T angle = l * theta;
  if (!(angle < T(1.57))) return false;
  const T a2 = angle * angle;
  const T r = angle < T(0.01) ? theta * (T(1) + a2 * (T(1.0 / 3) + a2 * T(2.0 / 15))) : tan(angle) / l;
  *x = r * px / across;
  *y = r * py / across;
  return true;
}

// (x, y) on the plane to (x', y'). `c`: coefficients in the order of distortion_names.
template <class T>
void distort(const T* c, const T& x, const T& y, T* xd, T* yd) {
  using L = LensTerm;
  const T r2 = x * x + y * y;
  const T above = T(1) + r2 * (c[L::k1] + r2 * (c[L::k2] + r2 * (c[L::k3] + r2 * (c[L::fisheye] * c[L::k4]))));
  const T below = T(1) + (T(1) - c[L::fisheye]) * (r2 * (c[L::k4] + r2 * (c[L::k5] + r2 * c[L::k6])));
  const T radial = above / below;
  const T xy = T(2) * x * y;
  *xd = x * radial + (c[L::p1] * xy + c[L::p2] * (r2 + T(2) * x * x)) + r2 * (c[L::s1] + r2 * c[L::s2]);
  *yd = y * radial + (c[L::p1] * (r2 + T(2) * y * y) + c[L::p2] * xy) + r2 * (c[L::s3] + r2 * c[L::s4]);
}

// d(x', y') / d(x, y), row-major.
std::array<double, 4> distortion_jacobian(const double* c, double x, double y);

// The whole map at a direction, with its derivatives.
struct LensMap {
  double x = 0, y = 0;                                            // distorted
  std::array<std::array<double, 3>, 2> by_direction{};            // d(x', y') / d(X, Y, Z)
  std::array<std::array<double, distortion_terms>, 2> by_term{};  // d(x', y') / d c
};
bool lens_map_derivatives(const double* c, Vec3 direction, LensMap& map);  // false as lay_on_plane

// Angle from the optical axis of the place at radius r on the plane; the inverse of r = tan(L theta) / L.
double angle_of_radius(double fisheye, double r);

// The radius r on the plane up to which r R(r) grows, so that the radial part is one-to-one, and up to which the plane
// shows directions (theta <= pi); infinity where there is no such limit.
double one_to_one_radius(const double* c);

}  // namespace gonio::camera
