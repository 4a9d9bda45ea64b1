// A triangle's neighbourhood on the surface: what is reached over edges that are not sharp, ring by ring outwards.
#pragma once
#include <cstdint>
#include <vector>

#include "geom/vector.h"
#include "mesh/adjacency.h"

namespace gonio::mesh {

// What neighbourhoods are looked for in. `guide`: unit normals of the triangles, free of most of their noise.
struct NoisySurface {
  const std::vector<Vec3>& positions_m;
  const std::vector<Corners>& triangles;
  std::vector<Corners> behind;  // over each edge
  std::vector<Vec3> centroids, guide;
  std::vector<std::uint8_t> sharp;  // bit c: edge c is an edge of the object
  double edge_m = 0;                // mean length
};
// Guided by the triangles' own normals, no edge sharp.
NoisySurface surface_of(const std::vector<Vec3>& positions_m, const std::vector<Corners>& triangles);
// Marks edges whose triangles' guides differ by more than the angle; returns how many.
std::size_t mark_sharp(NoisySurface& surface, double angle_rad);

// Numbers seen since clear(), by open addressing.
class SeenNumbers {
 public:
  void clear();
  bool insert(std::uint32_t number);  // was it new?

 private:
  void grow();
  struct Slot {
    std::uint32_t number = 0, stamp = 0;
  };
  std::vector<Slot> slots_ = std::vector<Slot>(512);
  std::uint32_t stamp_ = 1;
  std::size_t count_ = 0;
};

class Neighbourhood {
 public:
  explicit Neighbourhood(const NoisySurface& surface) : surface_(surface) {}
  void start(std::uint32_t face);
  // Adds all triangles whose centre is within the radius of that of the first; what turned away from it by more than 66
  // degrees is no function over its plane and stays out. New vertices stand behind those that were there.
  void grow(double radius_m);
  const std::vector<std::uint32_t>& vertices() const { return vertices_; }
  bool exhausted() const { return beyond_.empty(); }

 private:
  const NoisySurface& surface_;
  std::uint32_t face_ = 0;
  SeenNumbers seen_faces_, seen_vertices_;
  std::vector<std::uint32_t> vertices_, queue_, beyond_, later_;
};

}  // namespace gonio::mesh
