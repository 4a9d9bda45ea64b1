// See sampled_pixels.h.
#include "relighting/sampled_pixels.h"

#include <algorithm>

namespace gonio::relighting {
namespace {

constexpr std::uint64_t pixel_seed = 20;

}  // namespace

int degree_for(std::size_t surfaces) {
  constexpr std::size_t most_terms = 40;
  int degree = 6;
  while (degree > 1 && render::Monomials(surfaces, degree).size() > most_terms) --degree;
  return degree;
}

std::vector<std::uint8_t> counted_pixels(const Recordings& recordings, std::size_t view) {
  const camera::CameraModel& camera = recordings.views[view].model;
  std::vector<std::uint8_t> any(static_cast<std::size_t>(camera.width_px()) *
                                static_cast<std::size_t>(camera.height_px()));
  for (const Recording& image : recordings.images)
    if (image.view == view)
      for (std::size_t i = 0; i < any.size(); ++i) any[i] = any[i] | image.counts[i];
  return any;
}

std::vector<std::array<int, 2>> choose_pixels(const Recordings& recordings, std::size_t view,
                                              const std::vector<std::uint8_t>& marked, double count,
                                              const Accept& accept) {
  const int width = recordings.views[view].model.width_px(), height = recordings.views[view].model.height_px();
  const auto all = static_cast<double>(std::count(marked.begin(), marked.end(), 1));
  const double share = std::min(1.0, count / std::max(1.0, all));
  std::vector<std::array<int, 2>> chosen;
  for (int top = 0; top < height; top += tile_px)
    for (int left = 0; left < width; left += tile_px) {
      std::vector<std::array<int, 2>> tile;
      for (int y = top; y < std::min(height, top + tile_px); ++y)
        for (int x = left; x < std::min(width, left + tile_px); ++x)
          if (marked[static_cast<std::size_t>(y * width + x)]) tile.push_back({x, y});
      Random random(pixel_seed, static_cast<std::uint64_t>(view) << 40 | static_cast<std::uint64_t>(top) << 20 |
                                    static_cast<std::uint64_t>(left));
      // share of the tile, rounded up or down at random so that the mean is exact
      const auto take = static_cast<std::size_t>(share * static_cast<double>(tile.size()) + random.uniform());
      std::size_t taken = 0;
      for (std::size_t k = 0; k < tile.size() && taken < take; ++k) {
        const std::size_t other = k + random.below(static_cast<std::uint32_t>(tile.size() - k));
        std::swap(tile[k], tile[other]);
        if (!accept(tile[k], random)) continue;
        chosen.push_back(tile[k]);
        ++taken;
      }
    }
  return chosen;
}

bool shows_glass(const ViewCache& cache, const Pixel& pixel, const SceneState& state) {
  for (std::size_t f = pixel.first_facet; f < pixel.first_facet + pixel.facets; ++f)
    if (state.surfaces[cache.facets[f].surface].model->transmits()) return true;
  return false;
}

}  // namespace gonio::relighting
