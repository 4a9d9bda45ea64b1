// What roughness a set of directions can tell.
//
// A lobe of facets depends on the slope of the half vector, r = tan theta_h, and has its shape between the peak, r < a
// / 2, where GGX still has 0.64 of it, and the flank, a / 2 < r < 3 a / 2, down to 0.1. With a sample in either its
// height and width are two numbers from two readings; without, one of them is free. The least roughness is the
// smallest a above which every roughness has both.
#pragma once
#include <string>

#include "goniometry/samples.h"

namespace gonio::goniometry {

double least_alpha(const Samples& samples);
// "alpha < 0.02 cannot be told from these angles: ..."
std::string too_narrow(double least);

// How well these directions tell a direction of the sample, 0 .. 1, whatever its lobe is like. Reflection by facets
// without a direction depends on the angles of the half vector to the normal and to the light; with a direction, also
// on the half vector's azimuth p, in its first harmonic by cos 2p and sin 2p. What smooth functions of those two angles
// (hats over quantiles, 10 x 6) leave of the two is what tells: the root of the smaller eigenvalue of its 2 x 2 mean
// square over 1/2, so that no axis goes unseen. Zero in one plane; and from one azimuth between light and eye, where
// exchanged angles move every half vector along the same chord, so that one axis is not told from the lobe's shape.
double told_direction(const Samples& samples);
// Is that enough for a fit with a direction?
inline constexpr double least_told_direction = 0.25;  // one azimuth between light and eye leaves up to 0.15
bool turns_about_normal(const Samples& samples);

}  // namespace gonio::goniometry
