// What the views show, at half a pixel: cells of half a pixel's width and height, any number of which add up to what a
// pixel shows at another place. Cast where somebody looks, tile by tile; what a tile holds depends on its place alone.
//
// Cells are numbered from the picture's upper left corner, which has (0, 0); cell (i, j) covers (i / 2 - 1/2, j / 2 -
// 1/2) to half a pixel further in pixel coordinates. They go on beyond the borders of the picture. Where a cell and its
// neighbours show one surface evenly lit, one ray stands for it, else nine. Small lights only; no light by way of other
// surfaces.
#pragma once
#include <memory>
#include <mutex>

#include "relighting/light_cache.h"
#include "relighting/textures.h"
#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::relighting {

inline constexpr int tile_cells = 8;  // a side: 64 cells are the bits of a word
inline constexpr int margin_px = 24;  // beyond the borders of the picture

struct FineTile {
  ViewCache cells;             // 64 pixels of the finer camera, row by row
  std::vector<float> sums;     // facet_sums()
  std::vector<float> depth_m;  // of each facet, along the camera's axis
};

class FineView {
 public:
  FineView(const Tints& tints, const render::RayCaster& caster, const View& view, std::span<const LightSource> lights,
           const render::Monomials& monomials);
  ~FineView();
  int tiles_x() const { return tiles_x_; }
  int tiles() const { return tiles_x_ * tiles_y_; }
  // Number of the tile that holds a cell, and the cell's number in it; places beyond the margin are moved to its rim.
  struct Place {
    int tile, cell;
  };
  Place place_of(int i, int j) const;
  const FineTile& tile(int number) const;  // from any thread

 private:
  struct Slot;
  FineTile cast(int number) const;
  const Tints& tints_;
  const render::RayCaster& caster_;
  View fine_;
  std::span<const LightSource> lights_;
  const render::Monomials& monomials_;
  int tiles_x_ = 0, tiles_y_ = 0;
  std::unique_ptr<Slot[]> slots_;
};

class FineViews {
 public:
  FineViews(const scene::Scene& scene, const render::RayCaster& caster, const Recordings& recordings,
            std::span<const LightSource> lights, const render::Monomials& monomials);
  FineViews(const FineViews&) = delete;  // its views look at its tints
  FineViews& operator=(const FineViews&) = delete;
  const FineView& operator[](std::size_t view) const { return *views_[view]; }

 private:
  Tints tints_;
  std::vector<std::unique_ptr<const FineView>> views_;
};

}  // namespace gonio::relighting
