// Laws of variation: how a surface's parameter depends on where on the object it is looked at - on the normal (layers
// of a print), on the curvature (hand polishing), on height. A law is one file in laws/; any scalar parameter of any
// surface can follow one: "laws": {"alpha": {"law": "print-normal", "rho": 0.1, "s": 2}}.
#pragma once
#include <span>
#include <string>

#include "geom/vector.h"
#include "manifest/model.h"

namespace gonio::surface {

struct LocalGeometry {              // object frame
  Vec3 position_m, normal;          // unit, outwards
  double mean_curvature_per_m = 0;  // signed: H.n, positive where the object is hollow; 0 where the shape has none
};

class Law {
 public:
  virtual ~Law() = default;
  virtual const manifest::ModelInfo& info() const = 0;  // Family::law
  virtual bool needs_curvature() const { return false; }
  // `amounts` in the order of info().parameters. Within the bounds of what it governs? The caller clamps.
  virtual double value(std::span<const double> amounts, const LocalGeometry& here) const = 0;
};

std::span<const Law* const> all_laws();      // generated
const Law* find_law(const std::string& id);  // null pointer where there is none

}  // namespace gonio::surface
