// Arithmetic of Stokes vectors and Mueller matrices, turns of their frames, and the matrices of simple elements.
// Conventions: optics/mueller.h. Angles in radians, positive from x to y.
#pragma once
#include "optics/fresnel_amplitudes.h"
#include "optics/mueller.h"

namespace gonio::optics {

Mueller identity_mueller();
Mueller operator*(const Mueller& a, const Mueller& b);  // first b, then a
Stokes operator*(const Mueller& a, const Stokes& s);
Mueller operator*(const Mueller& a, double factor);
Mueller operator+(const Mueller& a, const Mueller& b);
Stokes operator+(const Stokes& a, const Stokes& b);
Stokes operator*(const Stokes& s, double factor);

// Over the (0, 0) element; a matrix whose (0, 0) is not positive becomes the depolarizer.
Mueller normalised(const Mueller& a);

// To the frame whose x axis is turned by `angle` (Born & Wolf's rotation): s1' = s1 cos 2a + s2 sin 2a.
Mueller frame_turned_by(double angle);
// Between frames of light that travels along the unit `d`, by their unit x axes, both perpendicular to d.
Mueller frame_change(Vec3 d, Vec3 from_x, Vec3 to_x);
// `a` between frames before and after that are both turned by `angle`: an element turned by it.
Mueller element_turned_by(const Mueller& a, double angle);

// The same element for light that goes the same way back, in frames with the same x and so with opposite y: Q a' Q,
// Q = diag(1, 1, -1, 1). Perrin 1942; van de Hulst 1957, section 5.22.
Mueller reversed(const Mueller& a);

// Of the field's map Ex -> x Ex, Ey -> y Ey, not normalised:
// s0' +- s1' = |x|^2, |y|^2 (s0 +- s1);  s2' + i s3' = x y* (s2 + i s3).
Mueller mueller_of(Complex x, Complex y);
Mueller linear_polarizer(double angle);                    // passes E along it
Mueller linear_retarder(double angle, double retardance);  // delays E along it by this phase

// Fresnel reflection and refraction at the complex relative index eta (beyond over before), x the s axis. (0, 0) is the
// reflectance of unpolarized light, and its transmittance: the flux that is carried on (zero for total reflection).
Mueller fresnel_reflection(double cosine, Complex eta);
Mueller fresnel_transmission(double cosine, Complex eta);

double degree_of_polarization(const Stokes& s);         // 0 for s0 = 0
double degree_of_linear_polarization(const Stokes& s);  // likewise
double angle_of_linear_polarization(const Stokes& s);   // of E, from x towards y, (-pi/2, pi/2]

}  // namespace gonio::optics
