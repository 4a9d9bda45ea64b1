// How far the nearest surface is at least, anywhere within some instances' box: what spares a walk its rays. World
// frame, metres.
//
// A grid over the box; cells that the surface may pass through are marked (triangles by their boxes), and every other
// cell knows its distance to a marked one in steps of any direction, k cells: the surface is at least (k - 1) cells
// off.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "geom/vector.h"
#include "scene/scene.h"

namespace gonio::relighting {

class Clearance {
 public:
  Clearance() = default;
  explicit Clearance(std::span<const scene::Instance> instances);
  double at(Vec3 p_m) const;  // 0 outside of the box

 private:
  Vec3 lower_m_;
  double cell_m_ = 1;
  int size_[3] = {0, 0, 0};
  std::vector<std::uint8_t> steps_;
};

}  // namespace gonio::relighting
