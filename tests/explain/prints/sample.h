// A small print of patterns for tests of explain/prints, and maps of it.
#pragma once
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/random.h"
#include "explain/prints/printed_field.h"
#include "explain/prints/prints_problem.h"

namespace gonio::explain::tests {

inline constexpr int side_px = 40;

inline double grey_at(int layer, int x, int y) {  // layers 0 and 1 are white; fields of ten pixels
  if (layer < 2) return 1;
  const int field = y / 10 * 4 + x / 10, u = x % 10, v = y % 10;
  const double along = (u + 0.5) / 10, down = (v + 0.5) / 10;
  const int top = 2 + field % 3;  // the layer that has the pattern; white beneath
  if (layer < top) return 1;
  if (field % 5 == 4) return layer == top ? 0.3 + 0.1 * (u / 2) : 0.12;  // faint later layers
  if (layer > top) return 0;
  switch (field % 4) {
    case 0: return along;
    case 1: return down;
    case 2: return (u / 2 + v / 2) % 2 == 0 ? 0.35 : 0.95;
    default: return u < 5 ? 0.5 : 1;
  }
}

inline prints::Sent sample(bool by_a_law = true) {
  prints::Sent sent;
  sent.printer.name = "p", sent.printer.place = "scene.json#/prints/p";
  sent.printer.width_px = sent.printer.height_px = side_px;
  sent.printer.pixel_m = {30e-6, 30e-6}, sent.printer.layer_m = 20e-6;
  if (by_a_law) sent.printer.growth = print::Growth(print::GrowthLaw{19.5e-6, 11e-6, -0.01});
  sent.box = {0, 0, side_px, side_px};
  sent.corner_m = sent.printer.grid().corner_m;
  for (int k = 0; k < 5; ++k) {
    std::vector<float>& layer = sent.layers.emplace_back();
    for (int y = 0; y < side_px; ++y)
      for (int x = 0; x < side_px; ++x) layer.push_back(static_cast<float>(grey_at(k, x, y)));
  }
  return sent;
}

// Two points for each pixel and axis, one for each cell of the simulation.
inline PrintsInput measured(const prints::Sent& sent, const prints::Setting& setting, double noise_m,
                            std::uint64_t seed) {
  const prints::Field field = prints::printed_field(sent, setting);
  PrintsInput input;
  input.name = "p", input.place = sent.printer.place, input.sent = sent;
  PrintedMap map;
  map.relief = "sample", map.place = "scene.json#/reliefs/sample";
  map.map.width = static_cast<std::size_t>(field.width), map.map.height = static_cast<std::size_t>(field.height);
  map.map.step_x_m = field.cell_m.x, map.map.step_y_m = field.cell_m.y;
  map.at_m = {sent.corner_m.x + 0.5 * field.cell_m.x, sent.corner_m.y + (field.height - 0.5) * field.cell_m.y};
  Random random(seed, 4);
  for (std::size_t row = 0; row < map.map.height; ++row)
    for (std::size_t column = 0; column < map.map.width; ++column)
      map.map.z_m.push_back(field.top_m[(map.map.height - 1 - row) * map.map.width + column] + 7e-6 +
                            1e-3 * field.cell_m.x * static_cast<double>(column) + noise_m * random.normal());
  input.maps.push_back(std::move(map));
  return input;
}

}  // namespace gonio::explain::tests
