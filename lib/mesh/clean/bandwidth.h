// What surface the data show at every triangle: local quadratics, each over as wide a neighbourhood as the data there
// bear.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "mesh/clean/noise.h"

namespace gonio::mesh {

// At a triangle's centre, in Basis(guide): h(u, v) in units of the mean edge. radius 0: no fit, the triangle is its
// own.
struct LocalSurface {
  std::array<float, 6> c{};
  float variance = 0;  // of the height, for unit noise
  float radius = 0;    // of the neighbourhood, mean edges
};
std::vector<LocalSurface> local_surfaces(const NoisySurface& surface, const VertexNoise& noise,
                                         const std::vector<double>& weights);

// Where a local surface is beside the triangle's centre: the point over p's foot, and the unit normal there.
struct SurfacePoint {
  Vec3 point{}, normal{};
};
SurfacePoint over(const NoisySurface& surface, const LocalSurface& local, std::uint32_t face, Vec3 p);

}  // namespace gonio::mesh
