// Families of closed bodies to be made of glass, one file each in forms/, drawn by chance.
//
// A body stands on the plane z = 0 with its middle over the origin, about one unit high or wide (whoever places it
// scales it). Every surface is closed, 2-manifold, oriented and free of self-intersections; a cavity is bounded by a
// surface of its own that looks into it. body.h checks that.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "base/random.h"
#include "io/ply.h"

namespace gonio::glass {

struct Body {
  io::TriangleMesh mesh;
  // What a liquid poured into it fills, closed; it reaches a little into the wall, which displaces it
  // (objects' priority).
  std::optional<io::TriangleMesh> filling{};
  double wall_low = 0, wall_high = 0;  // thinnest and thickest wall; 0: solid
};

class Form {
 public:
  virtual ~Form() = default;
  virtual const char* id() const = 0;        // "bottle"
  virtual const char* sentence() const = 0;  // for the man page
  // The same numbers give the same body.
  virtual Body made(Random& random) const = 0;
};

std::span<const Form* const> all_forms();      // generated; sorted by no order
const Form* find_form(const std::string& id);  // null pointer where there is none

}  // namespace gonio::glass
