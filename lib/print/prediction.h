// What a print will look like: the cured surface (print/cure.h) with what the printer adds, as a height map for
// roughness(1) and lobe(1), and as a mesh for render(1).
#pragma once
#include <cstdint>
#include <functional>

#include "io/height_map.h"
#include "io/ply.h"
#include "manifest/sections/forward.h"
#include "print/cure.h"

namespace gonio::print {

// What is added to a surface at a place of the platform, metres, of layers of a thickness.
using GroundAt = std::function<double(Vec2 at_m, double layer_m)>;
// The ground noise of the printer of Luongo et al. 2020, section 5, by their own noise (relief/sparse_convolution.h):
//   2/3 noise(x / 50 um) + 1/9 noise(x / 25 um) + 1/12 noise(x / 2 um)      of a layer's thickness.
GroundAt published_ground();
// What relief(1) has fitted to a printer's surfaces: its sum of noises, another for every seed; without the
// instrument's own.
GroundAt ground_of(const manifest::GroundNoiseFit& fit, std::uint64_t seed);

// Heights move by the noise, within the voxel that is the highest there: above it the membrane flattens what would
// grow, below it is solid (Luongo et al. 2020 clamp their grey values alike).
void add_ground(CuredSurface& surface, const GroundAt& ground);

// Seen from the projector, rows from the largest y on; NaN where nothing is solid.
io::HeightMap height_map_of(const CuredSurface& surface);
// The surface that is seen from the projector, two triangles between four solid points; without walls and undersides.
io::TriangleMesh mesh_of(const CuredSurface& surface);

}  // namespace gonio::print
