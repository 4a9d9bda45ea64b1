#include "relighting/fine_views.h"

#include <algorithm>
#include <cmath>

#include "relighting/shading.h"

namespace gonio::relighting {
namespace {

constexpr int few = 1, many = 3;      // rays along a cell's side
constexpr double same_normal = 0.98;  // cosine
constexpr double same_depth = 0.02;   // relative
constexpr int halo = tile_cells + 2;  // with a rim of cells around
constexpr int margin_cells = 2 * margin_px;

// Do two cells, each seen by one ray, show one surface lit alike?
bool alike(const ViewCache& cells, const std::vector<float>& depth_m, std::size_t a, std::size_t b,
           std::size_t lights) {
  const Pixel &p = cells.pixels[a], &q = cells.pixels[b];
  if (p.facets != q.facets) return false;
  if (p.facets == 0) return true;
  const Facet &f = cells.facets[p.first_facet], &g = cells.facets[q.first_facet];
  if (f.surface != g.surface) return false;
  const double near = depth_m[p.first_facet], far = depth_m[q.first_facet];
  if (std::abs(near - far) > same_depth * std::min(near, far)) return false;
  if (dot(cells.patches[f.first_patch].normal, cells.patches[g.first_patch].normal) < same_normal) return false;
  const auto lit = [&](const Facet& facet) {
    return cells.visible.begin() + static_cast<std::ptrdiff_t>(facet.first_patch * lights);
  };
  return std::equal(lit(f), lit(f) + static_cast<std::ptrdiff_t>(lights), lit(g));
}

std::vector<float> depths_of(const View& view, const ViewCache& cells) {
  const auto camera_from_world = inverse(view.world_from_camera);
  std::vector<float> depth_m;
  for (const Facet& f : cells.facets)
    depth_m.push_back(static_cast<float>((camera_from_world * cells.patches[f.first_patch].position_m).z));
  return depth_m;
}

template <class T>
void copy_rows(const std::vector<T>& from, std::vector<T>& to, std::size_t first, std::size_t count,
               std::size_t stride) {
  const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first * stride);
  to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(count * stride));
}

// Adds one pixel of another cache, with what belongs to it.
void append_pixel(const ViewCache& from, std::size_t number, std::size_t lights, ViewCache& to) {
  Pixel pixel = from.pixels[number];
  const std::size_t first = pixel.first_facet;
  pixel.first_facet = static_cast<std::uint32_t>(to.facets.size());
  to.pixels.push_back(pixel);
  for (std::size_t f = first; f < first + pixel.facets; ++f) {
    Facet facet = from.facets[f];
    copy_rows(from.direct, to.direct, facet.first_patch, facet.patches, lights * radii_m.size());
    copy_rows(from.visible, to.visible, facet.first_patch, facet.patches, lights);
    copy_rows(from.patches, to.patches, facet.first_patch, facet.patches, 1);
    facet.first_patch = static_cast<std::uint32_t>(to.patches.size() - facet.patches);
    to.facets.push_back(facet);
  }
}

}  // namespace

struct FineView::Slot {
  std::once_flag once;
  std::unique_ptr<const FineTile> tile;
};

FineView::FineView(const Tints& tints, const render::RayCaster& caster, const View& view,
                   std::span<const LightSource> lights, const render::Monomials& monomials)
    : tints_(tints),
      caster_(caster),
      fine_{view.camera, view.model.finer(2), view.world_from_camera},
      lights_(lights),
      monomials_(monomials),
      tiles_x_((fine_.model.width_px() + 2 * margin_cells + tile_cells - 1) / tile_cells),
      tiles_y_((fine_.model.height_px() + 2 * margin_cells + tile_cells - 1) / tile_cells),
      slots_(std::make_unique<Slot[]>(static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_y_))) {}
FineView::~FineView() = default;

FineView::Place FineView::place_of(int i, int j) const {
  const int x = std::clamp(i + margin_cells, 0, tile_cells * tiles_x_ - 1);
  const int y = std::clamp(j + margin_cells, 0, tile_cells * tiles_y_ - 1);
  return {y / tile_cells * tiles_x_ + x / tile_cells, y % tile_cells * tile_cells + x % tile_cells};
}

const FineTile& FineView::tile(int number) const {
  Slot& slot = slots_[static_cast<std::size_t>(number)];
  std::call_once(slot.once, [&] { slot.tile = std::make_unique<const FineTile>(cast(number)); });
  return *slot.tile;
}

FineTile FineView::cast(int number) const {
  const int left = number % tiles_x_ * tile_cells - margin_cells, top = number / tiles_x_ * tile_cells - margin_cells;
  std::vector<std::array<int, 2>> all, uneven;
  for (int j = -1; j <= tile_cells; ++j)
    for (int i = -1; i <= tile_cells; ++i) all.push_back({left + i, top + j});
  CacheOptions options{.samples = few, .paths = 0, .patches = 1, .penumbrae = false, .seed = 11};
  const ViewCache plain = build_cache(caster_, fine_, lights_, monomials_, all, options);
  const std::vector<float> depth_m = depths_of(fine_, plain);
  std::vector<std::size_t> places;  // of the tile's own cells
  std::vector<bool> even;
  for (int j = 0; j < tile_cells; ++j)
    for (int i = 0; i < tile_cells; ++i) {
      const auto own = static_cast<std::size_t>((j + 1) * halo + i + 1);
      bool same = true;
      for (int v = -1; v <= 1; ++v)
        for (int u = -1; u <= 1; ++u)
          same = same && alike(plain, depth_m, own, own + static_cast<std::size_t>(halo * (v + 1) + u + 1) - halo - 1,
                               lights_.size());
      places.push_back(own);
      even.push_back(same);
      if (!same) uneven.push_back(all[own]);
    }
  options.samples = many;
  const ViewCache fine = build_cache(caster_, fine_, lights_, monomials_, uneven, options);
  FineTile tile;
  std::size_t next = 0;
  for (std::size_t k = 0; k < places.size(); ++k)
    even[k] ? append_pixel(plain, places[k], lights_.size(), tile.cells)
            : append_pixel(fine, next++, lights_.size(), tile.cells);
  tints_.apply(caster_, fine_, tile.cells, 2);
  tile.sums = facet_sums(tile.cells);
  tile.depth_m = depths_of(fine_, tile.cells);
  return tile;
}

FineViews::FineViews(const scene::Scene& scene, const render::RayCaster& caster, const Recordings& recordings,
                     std::span<const LightSource> lights, const render::Monomials& monomials)
    : tints_(scene) {
  for (const View& view : recordings.views)
    views_.push_back(std::make_unique<const FineView>(tints_, caster, view, lights, monomials));
}

}  // namespace gonio::relighting
