// The figures of VDI/VDE 2634 part 2 for optical systems with area probing, from spheres and planes that were measured.
//
//   probing-form     PF = range of the distances from the fitted sphere (least squares, free radius unless held)
//   probing-size     PS = fitted minus calibrated diameter
//   sphere-distance  SD = measured minus calibrated distance of two spheres' centres
//   flatness         F  = range of the distances from the fitted plane
//
// Ranges are taken after at most 0.3 % of the points were left out (fitted_surface.h). Beside the guideline's worst
// case stand bias and standard deviation, over the points of one cloud, and over clouds where several were measured.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "metrology/fitted_surface.h"

namespace gonio::metrology {

struct Range {
  double value_m = 0, uncertainty_m = 0;  // uncertainty: one standard deviation of the value
};
// From 334 points on by a bootstrap of the farthest points, in which the rejection takes part; below by the spread of
// the extremes of exponential tails, pi / sqrt(6) times their mean excess (Gumbel 1958).
Range range_of(const Deviations& deviations, std::uint64_t seed);

manifest::AcceptanceResult probing_form(const SphereFit& sphere, std::optional<double> calibrated_radius_m,
                                        std::uint64_t seed);
manifest::AcceptanceResult probing_size(const SphereFit& sphere, double calibrated_radius_m);
manifest::AcceptanceResult sphere_distance(const SphereFit& a, const SphereFit& b, double calibrated_m);
manifest::AcceptanceResult flatness(const PlaneFit& plane, std::uint64_t seed);

// One entry more for every quantity that was measured in several places: the worst value, mean and standard deviation.
std::vector<manifest::AcceptanceResult> summaries(std::span<const manifest::AcceptanceResult> results);

}  // namespace gonio::metrology
