// Heights of a map, pixel by pixel of the projector, and what even fields say of their noise.
#pragma once
#include <cstdint>
#include <vector>

#include "explain/prints/prints_problem.h"

namespace gonio::explain::prints {

struct Reading {
  std::size_t map = 0;
  Vec2 at_m{};                          // mean place of its points, on the platform
  std::uint32_t first = 0, points = 0;  // in Readings::points
  int x_px = 0, y_px = 0;               // of the pixel, from the first of the box
  double z_um = 0, sigma_um = 0;
  std::uint32_t patch = 0, tile = 0;  // of its map: one of sixteen; 4 x 4 pixels
  // Of the simulation as stated: slopes (um for each pixel), what bends (um for each pixel squared), the layer that is
  // seen, the first being 1, its grey value, how far the top lies below the layer's, um.
  double slope_x = 0, slope_y = 0, bend = 0, grey = 0, below_top_um = 0, height_um = 0;
  int layer = 0;
};
struct Readings {
  std::vector<Reading> rows;       // by map, patch, tile
  std::vector<Vec2> points;        // places on the platform
  std::size_t without_points = 0;  // pixels of which a third was not measured
  double noise_um = 0;             // of one reading, on even fields
};
// Error(data) at the map's place where there are fewer than 400 readings.
Readings readings_of(const PrintsInput& input);
// Adds noise that is alike over some pixels: to every reading's, which then share blocks of `tile_px` x `tile_px`.
void add_noise(double rms_um, int tile_px, Readings& readings);

}  // namespace gonio::explain::prints
