// Whether a fit's numbers tell a metal from a dielectric, where its model is named after one.
//
// A metal has nothing beneath its facets: what is matte about a painted sample can only widen its lobe or bend its
// Fresnel curve. On the scale of errors such a fit may win, with numbers of no metal. What the facets reflect at the
// normal tells: R = f0, or ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2). The interface of a dielectric reflects as much
// if its index is (1 + sqrt R) / (1 - sqrt R). While R is, in every band, within what the models of dielectrics are
// made for (max_dielectric_f0 of surface/interface_albedo.h), the numbers do not tell one from the other.
//
// That is no reason to refuse the name: tables of real metals lack part of the light near the mirror direction where
// the instrument saturates or smooths, and read so, too (MERL's aluminium 15 to 18 %, brdf/merl-aluminium-slices).
//
// R has the standard deviation that the covariance of eta and k, or f0, gives it; nothing is said while two more of
// them would pass the limit.
#pragma once
#include <string>

#include "goniometry/fit.h"

namespace gonio::goniometry {

// What of the name of a metal the numbers do not tell, as words; empty of other models, and where they tell it.
std::string unlike_metals(const Fit& fit);

}  // namespace gonio::goniometry
