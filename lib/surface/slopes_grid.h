// Means over the normals that a direction sees: a midpoint rule on the two random numbers that draw them, finer where
// far slopes are drawn, which lose most. Deterministic, without noise.
#pragma once
#include <vector>

#include "surface/slopes.h"

namespace gonio::surface {

class SlopesGrid {
 public:
  // `half`: of the circle, where the other one is its mirror image (the same roughness along both axes).
  SlopesGrid(Slopes kind, int radii, int angles, bool half) {
    const bool ggx = kind == Slopes::ggx;
    for (int i = 0; i < radii; ++i) {
      const Cell c = ggx ? cell(i, radii, cubed) : cell(i, radii, smooth_step);
      rings_.push_back({ggx ? 1 - c.number : c.number, c.share});
    }
    for (int j = 0; j < angles; ++j) {
      const Cell c = cell(j, angles, ggx ? identity : half ? squared : smooth_step);
      const double turn = c.number * (half ? 0.5 : 1);
      spokes_.push_back({ggx ? turn - 0.25 + (turn < 0.25) : beckmann_visible_slope(1, 0, turn), c.share});
    }
  }
  // each(facet, share); the shares sum to one.
  template <Slopes kind, class Each>
  void over(const Facets<kind>& facets, Vec3 wo, const Each& each) const {
    const Vec3 v = facets.stretched(wo);
    const double sine = std::hypot(v.x, v.y);
    for (const Ring& ring : rings_) {
      const double along = kind == Slopes::beckmann ? beckmann_visible_slope(v.z, sine, ring.number) : 0;
      for (const Spoke& spoke : spokes_)
        each(facets.facet_of(kind == Slopes::ggx ? ggx_visible_normal(v, {ring.number, spoke.across})
                                                 : beckmann_normal(v, along, spoke.across)),
             ring.share * spoke.share);
    }
  }

 private:
  struct Cell {
    double number, share;
  };
  // Cell i of n equal ones, spread by a function from [0, 1] to itself.
  static Cell cell(int i, int n, double (*spread)(double)) {
    const double low = static_cast<double>(i) / n, high = (i + 1.0) / n;
    return {spread((low + high) / 2), spread(high) - spread(low)};
  }
  static double identity(double v) { return v; }
  static double squared(double v) { return v * v; }
  static double cubed(double v) { return v * v * v; }
  static double smooth_step(double v) { return v * v * (3 - 2 * v); }

  struct Ring {
    double number, share;  // the first random number
  };
  struct Spoke {
    double across, share;  // GGX: the second random number; Beckmann: the slope across the eye's direction
  };
  std::vector<Ring> rings_;
  std::vector<Spoke> spokes_;
};

}  // namespace gonio::surface
