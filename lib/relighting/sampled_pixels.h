// Which pixels of recordings are simulated, and the caches that simulate them: for all who fit the fast image model.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/random.h"
#include "relighting/image_model.h"
#include "render/ray_caster.h"

namespace gonio::relighting {

inline constexpr int tile_px = 8;

// The highest degree of the polynomials of light between surfaces: six, or fewer where many surfaces would make too
// many terms.
int degree_for(std::size_t surfaces);

// One for each pixel, rows from the top: 1 where it counts in any of the view's recordings.
std::vector<std::uint8_t> counted_pixels(const Recordings& recordings, std::size_t view);

// About `count` of the marked pixels of a view, as many of each tile as its share of them, drawn at random with a fixed
// seed; another one is drawn in the place of one that `accept` turns down. (x, y), tile by tile.
using Accept = std::function<bool(std::array<int, 2> pixel, Random& random)>;
std::vector<std::array<int, 2>> choose_pixels(const Recordings& recordings, std::size_t view,
                                              const std::vector<std::uint8_t>& marked, double count,
                                              const Accept& accept);

// Is something seen there that lets light through? That is not simulated.
bool shows_glass(const ViewCache& cache, const Pixel& pixel, const SceneState& state);

}  // namespace gonio::relighting
