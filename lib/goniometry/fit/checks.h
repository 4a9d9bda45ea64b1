// What every reflectance must keep, of a fit: energy, the share of light from any direction that leaves again, at most
// one; and reciprocity, f(wo, wi) = f(wi, wo).
#pragma once
#include "goniometry/fit/fit.h"

namespace gonio::goniometry {

// Greatest directional albedo over eight inclinations, by the model's own drawn directions (512 each, Roberts 2018).
double greatest_albedo(const Fit& fit);
// Greatest |f(wo, wi) - f(wi, wo)| over their mean, of up to 200 samples.
double reciprocity_error(const Fit& fit, const Samples& samples);

inline constexpr double energy_tolerance = 0.02;  // of the tables by which models keep energy, and of the sum

}  // namespace gonio::goniometry
