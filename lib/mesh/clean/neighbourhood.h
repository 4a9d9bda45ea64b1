// A triangle's neighbourhood on the surface: what is reached over edges that are not sharp, ring by ring outwards.
#pragma once
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "geom/vector.h"
#include "mesh/adjacency.h"

namespace gonio::mesh {

// All of a triangle in one place: neighbourhoods jump about.
struct NoisyFace {
  Vec3 centroid{}, guide{};                           // guide: unit normal, free of most of its noise
  Corners corners{}, behind{nobody, nobody, nobody};  // behind: over each edge
  std::uint32_t sharp = 0;                            // bit c: edge c is an edge of the object
};

// Marks which numbers were seen since the last clear(), for every user at a time its own.
class Marks {
 public:
  explicit Marks(std::size_t count) : stamps_(count, 0) {}
  void clear() {
    if (++stamp_ != 0) return;
    stamps_.assign(stamps_.size(), 0);
    stamp_ = 1;
  }
  bool has(std::uint32_t number) const { return stamps_[number] == stamp_; }
  void set(std::uint32_t number) { stamps_[number] = stamp_; }

 private:
  std::vector<std::uint32_t> stamps_;
  std::uint32_t stamp_ = 0;
};
struct FaceAndVertexMarks {
  Marks faces, vertices;
};

// What neighbourhoods are looked for in.
class NoisySurface {
 public:
  // Guided by the triangles' own normals, no edge sharp. Keeps references.
  NoisySurface(const std::vector<Vec3>& positions_m, const std::vector<Corners>& triangles);
  NoisySurface(std::vector<Vec3>&&, const std::vector<Corners>&) = delete;
  const std::vector<Vec3>& positions_m;
  const std::vector<Corners>& triangles;
  std::vector<NoisyFace> faces;
  double edge_m = 0;  // mean length

  std::unique_ptr<FaceAndVertexMarks> borrow_marks() const;
  void give_back(std::unique_ptr<FaceAndVertexMarks> marks) const;

 private:
  mutable std::mutex lock_;
  mutable std::vector<std::unique_ptr<FaceAndVertexMarks>> marks_;
};
// Marks edges whose triangles' guides differ by more than the angle; returns how many.
std::size_t mark_sharp(NoisySurface& surface, double angle_rad);

class Neighbourhood {
 public:
  explicit Neighbourhood(const NoisySurface& surface) : surface_(surface), marks_(surface.borrow_marks()) {}
  ~Neighbourhood() { surface_.give_back(std::move(marks_)); }
  Neighbourhood(const Neighbourhood&) = delete;
  Neighbourhood& operator=(const Neighbourhood&) = delete;
  void start(std::uint32_t face);
  // Adds all triangles whose centre is within the radius of that of the first; what turned away from it by more than 66
  // degrees is no function over its plane and stays out. New vertices stand behind those that were there.
  void grow(double radius_m);
  const std::vector<std::uint32_t>& vertices() const { return vertices_; }
  bool exhausted() const { return beyond_.empty(); }

 private:
  // How a triangle was reached: of its corners the one behind the edge alone is new.
  struct Reached {
    std::uint32_t face, from, apex;
  };
  void add_vertex(std::uint32_t v);

  const NoisySurface& surface_;
  std::unique_ptr<FaceAndVertexMarks> marks_;
  std::uint32_t face_ = 0;
  std::vector<std::uint32_t> vertices_;
  std::vector<Reached> queue_, beyond_, later_;
};

}  // namespace gonio::mesh
