// See prediction.h.
#include "print/prediction.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "manifest/sections/ground_noise.h"
#include "relief/noise.h"
#include "relief/sparse_convolution.h"

namespace gonio::print {

GroundAt published_ground() {
  struct Part {
    double weight, cell_m;
  };
  static constexpr Part parts[] = {{2.0 / 3, 50e-6}, {1.0 / 9, 25e-6}, {1.0 / 12, 2e-6}};
  return [](Vec2 at_m, double layer_m) {
    double sum = 0;
    for (const Part& part : parts) sum += part.weight * relief::published_noise(Vec3{at_m.x, at_m.y, 0} / part.cell_m);
    return layer_m * sum;
  };
}

GroundAt ground_of(const manifest::GroundNoiseFit& fit, std::uint64_t seed) {
  struct Part {
    relief::SparseNoise noise;
    double scale_m, cell_m;
  };
  std::vector<Part> parts;
  for (std::size_t i = 0; i < fit.parts.size(); ++i)
    parts.push_back(
        {relief::SparseNoise(seed + 1000003 * i), fit.parts[i].sq_m / relief::noise_sigma(), fit.parts[i].cell_m});
  return [parts](Vec2 at_m, double) {
    double sum = 0;
    for (const Part& part : parts) sum += part.scale_m * part.noise(Vec3{at_m.x, at_m.y, 0} / part.cell_m);
    return sum;
  };
}

void add_ground(CuredSurface& surface, const GroundAt& ground) {
  parallel_for(0, static_cast<std::size_t>(surface.height), [&](std::size_t y) {
    for (int x = 0; x < surface.width; ++x) {
      const std::size_t k = y * static_cast<std::size_t>(surface.width) + static_cast<std::size_t>(x);
      float& top = surface.top_m[k];
      if (!std::isfinite(top)) continue;
      const Vec2 at{surface.first_m.x + x * surface.step_m.x,
                    surface.first_m.y + static_cast<double>(y) * surface.step_m.y};
      const double low = static_cast<double>(surface.floor_m[k]), high = static_cast<double>(surface.ceiling_m[k]);
      top = static_cast<float>(std::clamp(static_cast<double>(top) + ground(at, high - low), low, high));
    }
  });
}

io::HeightMap height_map_of(const CuredSurface& surface) {
  io::HeightMap map{.width = static_cast<std::size_t>(surface.width),
                    .height = static_cast<std::size_t>(surface.height),
                    .step_x_m = surface.step_m.x,
                    .step_y_m = surface.step_m.y,
                    .z_m = {}};
  map.z_m.resize(surface.top_m.size());
  for (std::size_t y = 0; y < map.height; ++y)
    for (std::size_t x = 0; x < map.width; ++x)
      map.z_m[(map.height - 1 - y) * map.width + x] = static_cast<double>(surface.top_m[y * map.width + x]);
  return map;
}

io::TriangleMesh mesh_of(const CuredSurface& surface) {
  io::TriangleMesh mesh;
  constexpr std::uint32_t none = ~0u;
  std::vector<std::uint32_t> vertex(surface.top_m.size(), none);
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(surface.width) + static_cast<std::size_t>(x);
  };
  for (int y = 0; y < surface.height; ++y)
    for (int x = 0; x < surface.width; ++x) {
      if (!std::isfinite(surface.top_m[at(x, y)])) continue;
      vertex[at(x, y)] = static_cast<std::uint32_t>(mesh.positions_m.size());
      mesh.positions_m.push_back({surface.first_m.x + x * surface.step_m.x, surface.first_m.y + y * surface.step_m.y,
                                  static_cast<double>(surface.top_m[at(x, y)])});
    }
  for (int y = 0; y + 1 < surface.height; ++y)
    for (int x = 0; x + 1 < surface.width; ++x) {
      const std::uint32_t a = vertex[at(x, y)], b = vertex[at(x + 1, y)], c = vertex[at(x + 1, y + 1)],
                          d = vertex[at(x, y + 1)];
      if (a != none && b != none && c != none) mesh.triangles.push_back({a, b, c});
      if (a != none && c != none && d != none) mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

}  // namespace gonio::print
