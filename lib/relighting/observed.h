// What terms take from recordings themselves: sums over many pixels, or places far from the pixel at hand, whose noise
// is not that pixel's. Everything about cameras: which of a use's numbers an image has.
#pragma once
#include "relighting/light_cache.h"
#include "relighting/term.h"

namespace gonio::relighting {

// Mean of all finite pixels of the picture, masked ones too.
Rgb mean_of(const Recording& image);
// The value opposite a pixel about the picture's centre; black where it is not finite.
Rgb opposite(const Recording& image, const Pixel& pixel);
double largest_value(const Recordings& recordings);
// Readings within a hundredth of `value`, over all images.
std::size_t readings_near(const Recordings& recordings, double value);

// One use for each camera of the recordings that has not the mechanism already; a mechanism of cameras.
std::vector<Use> camera_uses(const Setting& setting, const mechanism::Mechanism& mechanism);
// The place in `on` that holds for an image: its own, else its camera's; 0 where the use names nothing and means all.
// Nothing: the use does not mean it.
std::optional<std::size_t> camera_target(const Use& use, const Recordings& recordings, const Recording& image);
// The numbers that hold for the frame's picture or its camera; neutral ones where the use does not mean it.
std::span<const double> camera_amounts(const Use& use, const Frame& frame);

}  // namespace gonio::relighting
