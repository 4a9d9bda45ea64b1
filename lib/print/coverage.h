// How much of every voxel of a layered print lies within a closed mesh: exact, layer by layer from the platform on.
//
// Over a place (x, y) of a closed mesh that faces outwards, the length of what is inside between the heights z0 and z1
// is
//   sum over the surfaces there of s clamp(z, z0, z1),  s = 1 where they face up, -1 where they face down,
// and, as the signs cancel, the same with any number taken off z. With z1 taken off, surfaces above the layer count for
// nothing, and those below by their signed area: a voxel's share is the integral of s (clamp(z, z0, z1) - z1) over the
// pixel, over (z1 - z0). Triangles are clipped to the layer, to rows and to pixels, and what is left is a convex
// polygon, over which a linear function is its mean times the polygon's area: no sample, no tolerance.
//
// Coincident faces of neighbours cancel, cavities count as what they are; where bodies overlap the sum exceeds 1, is
// cut there, and says so. Frame of the print: x along the rows of pixels, y along columns, z away from the platform;
// metres.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geom/vector.h"

namespace gonio::print {

struct PixelGrid {
  int width_px = 0, height_px = 0;
  Vec2 pixel_m{};   // along x, along y
  Vec2 corner_m{};  // outer corner of pixel (0, 0); its centre is half a pixel further
  std::size_t pixels() const { return static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px); }
};

struct PixelBox {  // x_begin <= x < x_end
  int x_begin = 0, y_begin = 0, x_end = 0, y_end = 0;
  bool empty() const { return x_begin >= x_end || y_begin >= y_end; }
};

struct LayerCoverage {
  double bottom_m = 0, top_m = 0;
  PixelBox box{};               // outside of it all is 0
  std::vector<double> share{};  // of the voxel, row by row, width_px x height_px; 0 to 1
  // Surfaces within this layer that face up, towards what is printed next, and down: of the pixel the part that they
  // cover; of the voxel what lies beneath the former, above the latter; and the triangle that covers most of it. Where
  // several lie in one voxel the sum. A flat top belongs to the layer that ends with it.
  struct Facing {
    std::vector<float> area{}, depth{};
    std::vector<std::uint32_t> triangle{};  // only where area is more than 0
  };
  Facing up{}, down{};
  double excess = 0;  // the most by which a voxel was more than full: above 1e-9 bodies overlap or the mesh is open
};

class CoverageSweep {
 public:
  // Triangles index `positions_m`, counter-clockwise seen from outside. Both must outlive the sweep. What lies outside
  // of the grid is not seen: Error(data) is the caller's to give.
  CoverageSweep(std::span<const Vec3> positions_m, std::span<const std::array<std::uint32_t, 3>> triangles,
                const PixelGrid& grid, double bottom_m);
  // The layer from where the last one ended (at first: `bottom_m`) up to `top_m`. What was below `bottom_m` at the
  // beginning counts as below. The same bytes for any number of threads.
  const LayerCoverage& next(double top_m);

 private:
  struct Slice;  // a triangle's part within a layer
  void admit(double bottom_m, double top_m);
  std::vector<Slice> slices(double bottom_m, double top_m) const;
  void fill(double bottom_m, double top_m);
  double fill_row(std::span<const Slice> slices, std::span<const std::uint32_t> mine, int row);

  std::span<const Vec3> positions_m_;
  std::span<const std::array<std::uint32_t, 3>> triangles_;
  PixelGrid grid_;
  std::vector<std::uint32_t> by_height_;  // triangles, by their lowest corner
  std::size_t admitted_ = 0;              // of them
  std::vector<std::uint32_t> active_;     // that reach into the layer, ascending
  std::vector<double> below_;             // signed area of what is below the layer, of the pixel
  LayerCoverage layer_;
};

}  // namespace gonio::print
