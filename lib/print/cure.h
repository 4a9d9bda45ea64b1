// From the light of all layers to the surface that they leave: what is seen from the projector, and what faces away.
//
// A layer's light is its picture, spread by the bleed. Light of a later layer goes through those before it and falls by
// e in every depth of penetration d (Beer and Lambert; overcure), so that layer k gets in all
//   G_k = L_k + exp(-t_(k+1) / d) G_(k+1),       t the layers' thickness,
// reckoned from the last layer down. There a voxel is solid up to h_k = min(growth(G_k), t_k) above the layer below it;
// the surface is the highest of z_k + h_k. A voxel that has no light of its own to cure it, but only what later layers
// send through them, hangs from the layer above instead: z_(k+1) - h_k is where the part begins, lower than was asked.
//
// Frame of the print: z away from the platform, towards the projector; metres. Rows of points, `samples` a pixel and
// axis, evenly within it: point (i, j) lies at corner + ((i + 1/2) / samples) pixels.
#pragma once
#include <limits>
#include <span>
#include <vector>

#include "print/printer.h"

namespace gonio::print {

struct CuredSurface {
  int width = 0, height = 0;  // points
  Vec2 step_m{}, first_m{};   // between points; the place of the first
  // Row by row; where nothing is solid, no number. Of the highest voxel: its top, where it begins and ends.
  std::vector<float> top_m, floor_m, ceiling_m;
  std::vector<float> underside_m;  // where the lowest begins
};

class Cure {
 public:
  // Of the pixels of `box` and no others; light from outside of it counts as none.
  Cure(const Printer& printer, const PixelBox& box, int samples = 1);
  // Layers from the last printed one down to the first. `light`: grey values 0 to 1 of the box's pixels, row by row;
  // what is no number counts as dark.
  void add(std::span<const float> light, double bottom_m, double top_m);
  const CuredSurface& surface() const { return surface_; }

 private:
  void settle(std::size_t point, double own, double bottom_m, double top_m, double kept);
  Printer printer_;
  PixelBox box_;
  int samples_;
  std::vector<Spread> spreads_;  // one for each of a pixel's points
  std::vector<float> total_;     // G of the layer above, of every point
  double above_m_ = 0;           // thickness of the layer above; 0: there is none
  double threshold_ = 0;         // of the growth
  CuredSurface surface_;
};

// All at once: `layers` from the platform up, each as large as `box`.
CuredSurface cured(const Printer& printer, const PixelBox& box, const std::vector<std::vector<float>>& layers,
                   double bottom_m, int samples = 1);

}  // namespace gonio::print
