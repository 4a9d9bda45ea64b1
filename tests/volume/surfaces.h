// What the tests of volume hold surfaces against: is it a manifold, does it intersect itself; and volumes to contour.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/random.h"
#include "io/volume.h"
#include "volume/contour.h"

namespace gonio::volume::tests {

class MemoryVolume : public io::VolumeSource {
 public:
  MemoryVolume(std::array<std::size_t, 3> size, std::vector<float> values);
  MemoryVolume(std::array<std::size_t, 3> size, const std::function<double(double i, double j, double k)>& value);
  void read(std::size_t first, std::size_t count, std::span<float> to) override;
  std::vector<float>& values() { return values_; }
  float at(std::size_t i, std::size_t j, std::size_t k) const {
    return values_[(k * head_.size[1] + j) * head_.size[0] + i];
  }

 private:
  std::vector<float> values_;
};

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
struct Soundness {
  std::size_t open_edges = 0;         // with one triangle
  std::size_t crowded_edges = 0;      // with more than two
  std::size_t disagreeing_edges = 0;  // passed twice the same way
  std::size_t pinched_vertices = 0;   // whose triangles do not form one closed fan
  std::size_t unused_vertices = 0;
  std::size_t collapsed_triangles = 0;  // without area, or with a corner twice
  std::int64_t euler = 0;               // vertices - edges + triangles
  bool sound() const;
  std::string text() const;
};
Soundness soundness(const std::vector<std::array<float, 3>>& positions, const Triangles& triangles);

// With exact predicates (CGAL's Polygon_mesh_processing): any two triangles that meet in more than the corner or edge
// they share.
bool intersects_itself(const std::vector<std::array<float, 3>>& positions, const Triangles& triangles);

double area(const Contour& surface);
double enclosed_volume(const Contour& surface);

// Sizes 3 to 9, shares of inside 0.1 to 0.9; every tenth a checkerboard with faults. Values are whole numbers 0 and 1.
MemoryVolume random_labels(std::uint64_t seed);
// Smooth noise of some wavelength, thin sheets, spheres that touch in corners, with and without noise of single
// samples.
MemoryVolume random_field(std::uint64_t seed);

}  // namespace gonio::volume::tests
