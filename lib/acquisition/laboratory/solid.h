// Solids that must not meet: boxes, balls, cylinders and triangle meshes, each fixed to the world or to one frame of an
// arm. Metres. A closed mesh is all that it encloses, an open one its triangles.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geom/rigid.h"

namespace gonio::acquisition {

struct Solid {
  enum class Shape { box, ball, cylinder, mesh };
  std::string name;  // "left/link-2", "left/camera", "pedestal"
  Shape shape = Shape::box;
  Vec3 sides_m{};                // box: full sides. ball: x is its radius. cylinder: x radius, y length, along z
  std::vector<Vec3> vertices_m;  // mesh
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::string arm;       // empty: it stands in the world
  int link = 0;          // of the arm: 0 its base, i after i joints, the last the flange
  bool carried = false;  // at the flange, not part of the arm
  // Takes the solid's coordinates to those of the world, or of the arm's frame `link`. (Every such frame: Denavit and
  // Hartenberg's, frame::Object.)
  Rigid<frame::World, frame::Object> placed{};
};

}  // namespace gonio::acquisition
