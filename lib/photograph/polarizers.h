// A polarizer over each sample, in super-pixels of 2 x 2 that begin at (0, 0), so that rows and columns of even number
// carry the first of each pair; degrees from the x of the Stokes vector's frame towards its y:
//    90   45
//   135    0
// Each polarizer's samples are interpolated at the place of every pixel on their own lattice, never taken for the
// super-pixel's: half a pixel between them would show as polarization at every edge (Ratliff, LaCasse & Tyo 2009,
// "Interpolation strategies for reducing IFOV artifacts in microgrid polarimeter imagery"). With four polarizers that
// are 45 degrees apart least squares are
//   s0 = (I0 + I45 + I90 + I135) / 2,   s1 = I0 - I90,   s2 = I45 - I135
// Each of the three is linear in the samples of a window of 5 x 5, and so is its variance with the squares of the
// weights.
#pragma once
#include "photograph/demosaic.h"

namespace gonio::photograph {

inline constexpr int polarizer_count = 4;

// Behind an ideal linear polarizer whose axis stands at `angle_rad` from the x of the Stokes vector's frame towards y:
// the first component of the polarizer's Mueller matrix times s, (s0 + s1 cos 2a + s2 sin 2a) / 2 (Collett 2005,
// equation 4-42).
double behind_polarizer(double s0, double s1, double s2, double angle_rad);

// Axis over a pixel, rad; in degrees.
double polarizer_angle(int x, int y);
int polarizer_degrees(int x, int y);

// Channels Y (s0), s1.Y and s2.Y: light before the polarizers.
//   bilinear   the mean of a polarizer's nearest samples
//   gradient   less their error by the curvature that the pixel's own polarizer sees, as far as it is common to all
// What cannot be trusted is left out as in demosaic(), which calls this.
Demosaiced stokes_of_polarizers(const MosaicSamples& samples, Demosaicing how);

}  // namespace gonio::photograph
