// Polarization: Stokes vectors, Mueller matrices and the frames that they refer to.
//
// A Stokes vector s = (s0, s1, s2, s3) of light that travels along the unit vector d refers to a frame (x, y, d),
// right-handed: s1 > 0 is polarized along x, s2 > 0 along x + y, s3 > 0 is right-handed as the receiver sees it
// (IEEE: E turns from y to x seen against the light). gonio-conventions(7) states how pictures use it.
//
// For the scattering of light that arrives from `wi` (travels along -wi) and leaves along `wo`, Model::mueller() states
// its matrix between the frames whose x is perpendicular to the plane of wi and wo (the s axis):
//   x_in = x_out = normalized(cross(wi, wo)),   y = cross(d, x)
// and any fixed x perpendicular to both where wi and wo are (anti)parallel: scattering_axis() says which.
#pragma once
#include <array>
#include <cmath>

#include "geom/vector.h"

namespace gonio::optics {

struct Stokes {
  std::array<double, 4> s{};
};

struct Mueller {
  std::array<double, 16> m{};  // row-major
  double operator()(int row, int column) const { return m[static_cast<std::size_t>(4 * row + column)]; }
  double& operator()(int row, int column) { return m[static_cast<std::size_t>(4 * row + column)]; }
  // What loses all polarization: 1 in the corner, 0 elsewhere.
  static Mueller depolarizer() {
    Mueller result;
    result(0, 0) = 1;
    return result;
  }
};
using MuellerRgb = std::array<Mueller, 3>;  // one per band

// The common x axis of the frames before and after scattering; see the head of the file.
inline Vec3 scattering_axis(Vec3 wi, Vec3 wo) {
  const Vec3 normal = cross(wi, wo);
  const double length = norm(normal);
  if (length > 1e-9) return normal / length;
  return Basis(wo).t;
}

}  // namespace gonio::optics
