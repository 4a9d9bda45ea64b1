// The lens as a map of normalised image coordinates: (x, y) = (X / Z, Y / Z) of a point in the camera frame (x right, y
// down, z forward, dimensionless) to distorted (x', y'), from which pixels follow as fx x' + cx, fy y' + cy.
//
//   x' = x R + 2 p1 x y + p2 (r^2 + 2 x^2) + s1 r^2 + s2 r^4       R = 1 + k1 r^2 + k2 r^4 + k3 r^6
//   y' = y R + p1 (r^2 + 2 y^2) + 2 p2 x y + s3 r^2 + s4 r^4       r^2 = x^2 + y^2
//
// Radial and tangential terms: Brown, "Close-range camera calibration", Photogrammetric Engineering 37(8), 1971, eq. 9,
// in OpenCV's order and sign; thin prism: Weng, Cohen & Herniou, PAMI 14(10), 1992, eq. 13, with the r^4 terms of
// OpenCV. The equations are templates over the scalar so that calibration differentiates the very terms that cameras
// evaluate; the mechanisms lens.radial, lens.tangential and lens.thin-prism (mechanisms/) name the coefficients.
// Invariant: a term whose coefficients are zero leaves the result bit-identical. Does not invert the map
// (camera_model.h).
#pragma once
#include <array>
#include <cstddef>
#include <string_view>

namespace gonio::camera {

inline constexpr std::size_t distortion_terms = 9;
inline constexpr std::array<std::string_view, distortion_terms> distortion_names = {"k1", "k2", "p1", "p2", "k3",
                                                                                    "s1", "s2", "s3", "s4"};

// `c`: coefficients in the order of distortion_names.
template <class T>
void distort(const T* c, const T& x, const T& y, T* xd, T* yd) {
  const T r2 = x * x + y * y;
  const T radial = T(1) + r2 * (c[0] + r2 * (c[1] + r2 * c[4]));
  const T xy = T(2) * x * y;
  *xd = x * radial + (c[2] * xy + c[3] * (r2 + T(2) * x * x)) + r2 * (c[5] + r2 * c[6]);
  *yd = y * radial + (c[2] * (r2 + T(2) * y * y) + c[3] * xy) + r2 * (c[7] + r2 * c[8]);
}

// d(x', y') / d(x, y), row-major.
inline std::array<double, 4> distortion_jacobian(const double* c, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (c[0] + r2 * (c[1] + r2 * c[4]));
  const double slope = c[0] + r2 * (2 * c[1] + r2 * 3 * c[4]);  // dR / d(r^2)
  const double prism_x = c[5] + 2 * r2 * c[6], prism_y = c[7] + 2 * r2 * c[8];
  const double mixed = 2 * x * y * slope + 2 * c[2] * x + 2 * c[3] * y;
  return {radial + 2 * x * x * slope + 2 * c[2] * y + 6 * c[3] * x + 2 * x * prism_x, mixed + 2 * y * prism_x,
          mixed + 2 * x * prism_y, radial + 2 * y * y * slope + 6 * c[2] * y + 2 * c[3] * x + 2 * y * prism_y};
}

// The radius r up to which r R(r) grows, so that the radial part is one-to-one; infinity where it always grows.
double one_to_one_radius(double k1, double k2, double k3);

}  // namespace gonio::camera
