// What lies in the scanner: bodies of materials, in metres, the rotation axis being z and the origin the centre of the
// volume.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "ct/matter.h"
#include "ct/shape.h"

namespace gonio::ct {

struct Part {
  std::string name;
  ShapePtr shape;
  Material material;
};

// Where parts overlap, the first that is listed is there.
struct Phantom {
  std::string name;
  std::vector<Part> parts;
  std::vector<Ball> markers;  // the true spheres, which are parts as well: "markers"

  void lengths(const Ray& ray, std::span<double> of_parts) const;  // metres of the ray in each part
  double distance_m(Vec3 p, std::size_t part) const;               // to the part's surface, negative inside
  double distance_m(Vec3 p) const;                                 // to what is not air
  std::size_t part_at(Vec3 p) const;                               // parts.size(): air
  std::size_t part_named(const std::string& part) const;           // std::out_of_range where there is none
};

// Ready phantoms, for volumes of `voxels` voxels of `voxel_m` along each axis: they fill about 80 % of the circle.
struct Place {
  std::size_t voxels = 128;
  double voxel_m = 1e-4;
  double extent() const { return static_cast<double>(voxels) * voxel_m; }
};
Phantom glass_block(const Place& place);                           // a cylinder lying slightly askew, for cupping
Phantom glass_tube(const Place& place, double wall_voxels = 2.5);  // open at both ends, axis 7 degrees from z
Phantom hollow_sphere(const Place& place, double wall_voxels = 4);
Phantom bowl_with_lid(const Place& place, double wall_voxels = 4);
// A pot with a spout, a handle and nine spherical markers of `marker_voxels` radius glued outside: by default plastic
// that is filled and shines out, ct::plastic() for markers that are fainter than glass.
Phantom teapot(const Place& place, double wall_voxels = 3, double marker_voxels = 0,
               const Material& markers = filled_plastic());
Phantom step_block(const Place& place);  // aluminium with flat faces, none along an axis, and a bore: for edges

}  // namespace gonio::ct
