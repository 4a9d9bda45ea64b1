// Polarization: Stokes vectors, Mueller matrices and the frames that they refer to.
//
// A Stokes vector s = (s0, s1, s2, s3) of light that travels along the unit vector d refers to a frame (x, y, d),
// right-handed. With the complex amplitudes of the field along x and y, varying as exp(-i omega t):
//   s0 = |Ex|^2 + |Ey|^2,  s1 = |Ex|^2 - |Ey|^2,  s2 = 2 Re(Ex Ey*),  s3 = 2 Im(Ex Ey*)
// s1 > 0 is polarized along x, s2 > 0 along x + y. s3 > 0 is right-circular in the sense of optics (Born & Wolf 1999,
// section 1.4.2): a receiver who looks at the source sees E turn clockwise, from y to x. IEEE and radio engineers, who
// look along d, call the same light left-handed. A polarizer at the angle a from x (towards y) passes
// (s0 + s1 cos 2a + s2 sin 2a) / 2. gonio-conventions(7) states how pictures use it.
//
// For the scattering of light that arrives from `wi` (travels along -wi) and leaves along `wo`, Model::mueller() states
// its matrix between the frames whose x is perpendicular to the plane of wi and wo (the s axis):
//   x_in = x_out = normalized(cross(wi, wo)),   y = cross(d, x)
// and any fixed x perpendicular to both where wi and wo are (anti)parallel: scattering_axis() says which. Which of the
// two signs x has does not matter: half a turn of a frame leaves Stokes vectors as they are. The plane of wi and wo
// contains the facet's normal in reflection as in refraction, so rough interfaces need no other frame.
// Products, rotations and Fresnel's matrices: optics/mueller_algebra.h.
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
