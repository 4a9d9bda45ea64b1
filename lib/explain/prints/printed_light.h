// The light of the layers that were sent, on cells of half a pixel: displaced, out of focus, spread.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "geom/vector.h"
#include "print/printer.h"

namespace gonio::explain::prints {

inline constexpr int cells_per_pixel = 2;

struct Sent {  // what the printer was given: all layers from the platform up, of the pixels of `box`
  print::Printer printer;
  print::PixelBox box;
  std::vector<std::vector<float>> layers;
  Vec2 corner_m{};  // outer corner of the box
  Vec2 centre_m{};  // about which prints shrink: the middle of the maps
  int wide() const { return box.x_end - box.x_begin; }
  int high() const { return box.y_end - box.y_begin; }
  Vec2 cell_m() const { return printer.pixel_m * (1.0 / cells_per_pixel); }
};
struct Setting {  // the simulation's numbers
  print::Printer printer;
  double shifted_from = 0;  // layer, the first being 1; 0: none
  Vec2 shift_m{};
  Vec2 tilt{};  // slopes of the blur over the field
  double cut_m = 0;
  Vec3 shrinkage{};
};
inline Setting stated(const Sent& sent) {
  return {.printer = sent.printer};
}

using Lights = std::vector<std::vector<float>>;  // of every layer, from the platform up; cells row by row
// Of the tails alone, with all of the light, of this half width: they are dear, and the same whatever the core is.
using TailsOf = std::function<std::shared_ptr<const Lights>(double tail_m)>;
Lights tails_of(const Sent& sent, double tail_m);
// Without any displacement.
Lights lights_of(const Sent& sent, const Setting& setting, const TailsOf& tails_of);
// Layers from `shifted_from` on lie so many whole cells further; what comes in is dark.
Lights moved(const Lights& lights, const Sent& sent, double shifted_from, int by_x, int by_y);

}  // namespace gonio::explain::prints
