// What is known of every row and may carry the signature of missing physics: angles at the surface, distances, places
// in the image.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "explain/engine.h"
#include "explain/images/model.h"

namespace gonio::explain::images {

// Brightness opposite about the centre and the picture's mean are the recording's: their noise is not that of the
// pixel. camera.pixel is how far the same pixel stands out from its neighbours in other views (fixed_pattern.h). One
// row per picked pixel and channel, images in order. `prediction`: of the base model, one per row; structure that
// scales with the signal is a curve over a condition times it. `across`: its change from one pixel to the next, along x
// and y: what is seen elsewhere leaves a residual of that times the displacement (camera.edge-shift). Angles in rad;
// with several lights on, the first counts.
std::vector<Condition> image_conditions(const ImageModel& model, const std::vector<std::vector<std::uint32_t>>& picked,
                                        std::span<const double> prediction,
                                        const std::array<std::vector<double>, 2>& across);

}  // namespace gonio::explain::images
