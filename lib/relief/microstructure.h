// Micro-structures: patterns that a process leaves, or is asked to leave, on a surface, as a share of the depth that it
// controls: 0 at the bottom of the topmost voxel, 1 at its top. One file each in microstructures/.
//
// Place: metres along two axes of the surface (u, v), and in the body's own frame (x, y, z); a structure uses one or
// the other. Where the surface has no axes of its own, u and v are x and y. The directions of u and v at the place, in
// the body's frame, tangent to the surface, are for structures of space that follow the surface.
#pragma once
#include <functional>
#include <span>
#include <string>

#include "geom/vector.h"
#include "io/grey.h"
#include "manifest/model.h"

namespace gonio::relief {

struct SurfacePlace {
  Vec2 along_m;  // u, v
  Vec3 body_m;   // x, y, z
  Vec3 u{1, 0, 0}, v{0, 1, 0};
};
struct MicrostructureFiles {  // what is not a number
  const io::GreyImage* picture = nullptr;
  std::string expression{};  // of base/expression.h
};
using ShareAt = std::function<double(const SurfacePlace&)>;  // 0 to 1; any thread

class Microstructure {
 public:
  virtual ~Microstructure() = default;
  virtual const manifest::ModelInfo& info() const = 0;  // Family::microstructure
  // `amounts` in the order of info().parameters; `depth_m`: what a share of 1 is, the thickness of a layer. What
  // `files` holds must outlive the function. Error(data) at `place` where a picture or an expression is missing or does
  // not parse, and where the structure is deeper than `depth_m`.
  virtual ShareAt made(std::span<const double> amounts, double depth_m, const MicrostructureFiles& files,
                       const std::string& place) const = 0;
};

std::span<const Microstructure* const> all_microstructures();      // generated; sorted by no order
const Microstructure* find_microstructure(const std::string& id);  // null pointer where there is none

}  // namespace gonio::relief
