// A cell's pictures: rendered, recorded by a polarization camera, and what is to be learnt from them.
#pragma once
#include <array>

#include "glass/set.h"
#include "io/image.h"

namespace gonio::glass {

// Into folder_of(cell), cell.json last: bare.exr and lit.exr (render(1)'s layers with Stokes vectors, and in their
// heads the cell's facts), bare-mosaic.exr and lit-mosaic.exr (what the sensor reads, with its noise). Goes on from an
// interrupted call's checkpoints; the bytes are those of one that was not. False where the cell was finished before.
bool make_cell(const GlassSet& set, const Cell& cell);
bool is_made(const GlassSet& set, const Cell& cell);

// Surfaces that the ray through each pixel's centre crosses, refracted at each, until it leaves the glass for good:
// 0 where it misses; mean, largest over the pixels that meet the object.
struct RayDepth {
  double mean = 0;
  int largest = 0;
  std::vector<std::size_t> count;  // of pixels by depth, from 0
};
RayDepth ray_depth(const Cell& cell);

}  // namespace gonio::glass
