// Noise from further takes of the same recordings: a manifest with images of the same ids, or pictures of the same
// file names. The variance of the difference of two takes is twice that of one: per image v / gain + read^2 is fitted
// to half the squared differences over the brightness, in twenty bins of equal counts, each by its median (chi-square
// with one degree of freedom has 0.4549 there), weighted by its own square.
#pragma once
#include <filesystem>
#include <span>

#include "relighting/recordings.h"

namespace gonio::relighting {

// Replaces the noise of images that have a further take. Error(data) where a file fits no image or has another size.
void measure_noise(std::span<const std::filesystem::path> repeats, const manifest::Document& document,
                   Recordings& recordings);

}  // namespace gonio::relighting
