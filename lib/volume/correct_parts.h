// Pieces of corrected(): what is done to one slice, or to one block of slices.
#pragma once
#include <cstddef>
#include <span>

#include "volume/correct.h"

namespace gonio::volume {

// Rows of `width`; rings are estimated from this slice alone.
void take_off_rings(std::span<float> slice, std::size_t width, std::size_t height, const RingWish& wish);

// Slices that a voxel's new value may depend on, on either side.
inline constexpr std::size_t denoise_reach = 8;
// In place; values within `denoise_reach` of the block's first and last slice are right only at the volume's ends.
void denoise_block(std::span<float> block, std::size_t width, std::size_t height, std::size_t depth,
                   const CorrectWish& wish);

}  // namespace gonio::volume
