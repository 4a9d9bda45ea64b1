// A printed surface, simulated from what was sent: pictures, displaced and blurred over the field; light spread, added
// up over layers and cured (print/cure.h); tops cut at the membrane. Cells of half a pixel.
//
// Frame of the platform (manifest/sections/print.h), metres. Heights over the platform.
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

struct Field {  // of cells, row by row from the smallest y
  int width = 0, height = 0;
  Vec2 corner_m{}, cell_m{};    // outer corner
  std::vector<double> top_m;    // 0 where nothing is solid
  std::vector<double> floor_m;  // of the layer that is seen
  std::vector<double> ceiling_m;
};
// The light of every layer on the cells, from the platform up; and what it makes. Few settings change the first. Layers
// are displaced by whole cells: by parts of a cell, areas are, and heights of the surfaces of whole ones are averaged.
using Lights = std::vector<std::vector<float>>;
print::Spread spread_of(const Sent& sent, const print::Bleed& bleed);
Lights lights_of(const Sent& sent, const Setting& setting, const print::Spread& spread);
using LightsOf = std::function<std::shared_ptr<const Lights>(const Setting&)>;
Field printed_field(const Sent& sent, const Setting& setting, const LightsOf& lights_of);
Field printed_field(const Sent& sent, const Setting& setting);

// The field as an instrument sees it: means over the square that a point of the map stands for, blurred by the
// instrument's resolution, a Gaussian; lengths in cells, places from the outer corner. Between knots, a quarter of a
// cell apart, linear.
class Seen {
 public:
  Seen(const Field& field, const std::vector<double>& values, Vec2 point_cells, double resolution_cells);
  double at(double x_cells, double y_cells) const;

 private:
  int width_ = 0, height_ = 0;  // knots
  std::vector<double> knot_;
};

}  // namespace gonio::explain::prints
