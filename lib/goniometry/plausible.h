// Whether a fit's constants describe what its model is named after.
//
// A metal has nothing beneath its facets: what is matte about a painted sample can only widen its lobe or bend its
// Fresnel curve. On the scale of errors such a fit may win, with constants of no metal. In visible light metals reflect
// a third or more at the normal in the band where they reflect most (tungsten and chromium half, copper and gold in the
// red nine tenths), semiconductors and graphite a quarter (Palik 1985); dielectrics up to 0.17 (diamond). The limit
// lies between: `least_metal`.
//
// The reflectance at the normal is f0, or ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2) with the standard deviation that
// the covariance of eta and k gives it. A fit is not doubted while two standard deviations more would reach the limit.
#pragma once
#include <string>

#include "goniometry/fit.h"

namespace gonio::goniometry {

inline constexpr double least_metal = 0.18;

// Why a model that is named a metal is none, as words after "its numbers describe no known metal: "; else empty.
std::string unlike_metals(const Fit& fit);

}  // namespace gonio::goniometry
