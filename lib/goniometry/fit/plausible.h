// What a fit's numbers say about the samples that were fitted: their unit, and whether a metal's name is deserved.
//
// Units: a surface that predicts the samples worse than a constant does describes nothing. Where an albedo or f0 stands
// at its upper bound, the samples are brighter than a surface that returns all light: of a white one that may be noise,
// else the values are no BRDF in 1/sr; reflectance factors are pi times as large.
//
// Metals: // A metal has nothing beneath its facets: what is matte about a painted sample can only widen its lobe or
// bend its Fresnel curve. On the scale of errors such a fit may win, with numbers of no metal. What the facets reflect
// at the normal tells: R = f0, or ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2). The interface of a dielectric reflects as
// much if its index is (1 + sqrt R) / (1 - sqrt R). While R is, in every band, within what the models of dielectrics
// are made for (max_dielectric_f0 of surface/interface_albedo.h), the numbers do not tell one from the other.
//
// That is no reason to refuse the name: tables of real metals lack part of the light near the mirror direction where
// the instrument saturates or smooths, and read so, too (MERL's aluminium 15 to 18 %, brdf/merl-aluminium-slices).
//
// R has the standard deviation that the covariance of eta and k, or f0, gives it; nothing is said while two more of
// them would pass the limit.
#pragma once
#include <string>

#include "goniometry/fit/fit.h"

namespace gonio::goniometry {

// Its rms exceeds that of the samples about their own mean, both of log(1 + 100 f cos cos) and over all bands, by a
// tenth.
bool worse_than_a_constant(const Fit& fit, const Samples& samples);
// Which colours are at their upper bounds, in words; empty: none.
std::string brighter_than_possible(const Fit& fit);

// What of the name of a metal the numbers do not tell, as words; empty of other models, and where they tell it.
std::string unlike_metals(const Fit& fit);

}  // namespace gonio::goniometry
