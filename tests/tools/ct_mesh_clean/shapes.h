// Small volumes for the tests of ct-mesh-clean: shapes by their distance, edges of a given width, noise.
#pragma once
#include <cmath>
#include <functional>

#include "base/random.h"
#include "io/volume.h"

namespace gonio::tests {

struct Shape {
  std::function<double(Vec3)> distance;  // negative inside, voxels
  double value = 0;
};

// Values of the last shape that a voxel lies in, air 100; spread of an edge 0.8 voxel (one standard deviation).
inline io::VolumeData volume_of(std::size_t side, const std::vector<Shape>& shapes, double noise, std::uint64_t seed,
                                std::optional<double> spacing_m = 1e-4) {
  io::VolumeData out;
  out.head.size = {side, side, side}, out.head.type = io::VoxelType::u16;
  if (spacing_m) out.head.spacing_m = Vec3{*spacing_m, *spacing_m, *spacing_m};
  Random random(seed);
  out.values.reserve(side * side * side);
  for (std::size_t k = 0; k < side; ++k)
    for (std::size_t j = 0; j < side; ++j)
      for (std::size_t i = 0; i < side; ++i) {
        double value = 100;
        for (const Shape& s : shapes) {
          const double inside =
              0.5 * std::erfc(s.distance({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}) /
                              (0.8 * std::sqrt(2.0)));
          value += inside * (s.value - value);
        }
        out.values.push_back(static_cast<float>(std::round(std::max(0.0, value + noise * random.normal()))));
      }
  return out;
}

inline Shape ball(Vec3 centre, double radius, double value) {
  return {[=](Vec3 p) { return norm(p - centre) - radius; }, value};
}
// Wall of a hollow sphere between two radii.
inline Shape shell(Vec3 centre, double inner, double outer, double value) {
  return {[=](Vec3 p) {
            const double r = norm(p - centre);
            return std::max(inner - r, r - outer);
          },
          value};
}

}  // namespace gonio::tests
