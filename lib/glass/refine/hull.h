// The visual hull of several views' outlines (Laurentini 1994, "The visual hull concept for silhouette-based image
// understanding"), as a smooth function: at a point the least, over the views, of its distance from the outline in
// pixels times what a pixel is worth there.
#pragma once
#include <optional>
#include <span>

#include "glass/refine/spline_field.h"
#include "glass/refine/view.h"

namespace gonio::glass {

struct HullWish {
  int cells = 36;                   // along the object's longest side
  std::optional<double> floor_m{};  // it stands on the plane z = this
};
// Error(data) where the outlines have nothing in common.
SplineField hull_of(std::span<const View> views, const HullWish& wish);

// Metres, positive inside.
double hull_at(std::span<const View> views, const HullWish& wish, Vec3 point_m);

}  // namespace gonio::glass
