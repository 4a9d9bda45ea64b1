#include "relighting/sight.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gonio::relighting {
namespace {

// Cells that the square of a pixel about `centre` covers, with the share of the square that lies in each.
template <class Visit>
void cells_of(Vec2 centre, const Visit& visit) {
  const double left = 2 * centre.x, top = 2 * centre.y;
  const int i0 = static_cast<int>(std::floor(left)), j0 = static_cast<int>(std::floor(top));
  const auto share = [](double from, int cell) {
    return std::max(0.0, std::min(from + 2, cell + 1.0) - std::max(from, static_cast<double>(cell))) / 2;
  };
  for (int j = j0; j <= j0 + 2; ++j)
    for (int i = i0; i <= i0 + 2; ++i) {
      const double part = share(left, i) * share(top, j);
      if (part > 0) visit(i, j, part);
    }
}

}  // namespace

void Sight::look_at(Vec2 centre) {
  cells_of(centre, [&](int i, int j, double) {
    const FineView::Place place = view_.place_of(i, j);
    std::int32_t& at = place_[static_cast<std::size_t>(place.tile)];
    if (at < 0) {
      at = static_cast<std::int32_t>(tiles_.size());
      tiles_.push_back({.tile = &view_.tile(place.tile), .direct = {}});
    }
    tiles_[static_cast<std::size_t>(at)].wanted |= std::uint64_t{1} << place.cell;
  });
}

void Sight::shade() {
  std::vector<std::uint32_t> picked;
  for (Shaded& shaded : tiles_) {
    const ViewCache& cells = shaded.tile->cells;
    picked.clear();
    for (std::uint64_t left = shaded.wanted; left != 0; left &= left - 1)
      picked.push_back(static_cast<std::uint32_t>(std::countr_zero(left)));
    const std::vector<Rgb> direct =
        frame_.model.direct_from(cells, shaded.tile->sums, frame_.state, frame_.number, picked);
    shaded.direct.resize(cells.facets.size());
    std::size_t slot = 0;
    for (const std::uint32_t cell : picked)
      for (std::uint32_t k = 0; k < cells.pixels[cell].facets; ++k)
        shaded.direct[cells.pixels[cell].first_facet + k] = direct[slot++];
  }
}

Sight::Sum Sight::at(Vec2 centre, std::uint32_t pixel, Which which) {
  const float split_m = places_.depths[frame_.image.view][pixel].split_m;
  Sum sum;
  std::uint32_t surface = 0xffffffffu;  // that `sent_on` is of: neighbouring cells show one
  Rgb sent_on;
  cells_of(centre, [&](int i, int j, double part) {
    const FineView::Place place = view_.place_of(i, j);
    const Shaded& shaded = tiles_[static_cast<std::size_t>(place_[static_cast<std::size_t>(place.tile)])];
    const ViewCache& cells = shaded.tile->cells;
    const Pixel& cell = cells.pixels[static_cast<std::size_t>(place.cell)];
    if (which != Which::near && cell.sky > 0) {
      sum.radiance += frame_.state.ambient * (part * cell.sky);
      sum.share += part * cell.sky;
    }
    for (std::uint32_t f = cell.first_facet; f < cell.first_facet + cell.facets; ++f) {
      if (which != Which::all && (shaded.tile->depth_m[f] < split_m) != (which == Which::near)) continue;
      const Facet& facet = cells.facets[f];
      if (facet.surface != surface) surface = facet.surface, sent_on = onward(pixel, surface);
      sum.radiance += (shaded.direct[f] + sent_on * facet.tint * facet.weight) * part;
      sum.share += part * facet.weight;
    }
  });
  return sum;
}

Rgb Sight::onward(std::uint32_t number, std::uint32_t surface) {
  const Pixel& pixel = frame_.cache.pixels[number];
  for (std::uint32_t f = pixel.first_facet; f < pixel.first_facet + pixel.facets; ++f)
    if (frame_.cache.facets[f].surface == surface) return onward_of(f);
  const std::size_t surfaces = frame_.state.surfaces.size();
  const int across = blocks_across(frame_.image.picture.width);
  const auto block = static_cast<std::size_t>(pixel.y / block_px * across + pixel.x / block_px);
  const std::uint32_t nearest = places_.nearest[frame_.image.view][block * surfaces + surface];
  return nearest < frame_.cache.facets.size() ? onward_of(nearest) : Rgb{};
}

Rgb Sight::onward_of(std::size_t facet) {
  std::optional<Rgb>& known = known_[facet];
  if (known) return *known;
  const Rgb tint = frame_.cache.facets[facet].tint, sent = onward_(facet);
  const auto over = [](double value, double usual) { return usual > 0 ? value / usual : value; };
  known = Rgb{over(sent.x, tint.x), over(sent.y, tint.y), over(sent.z, tint.z)};
  return *known;
}

}  // namespace gonio::relighting
