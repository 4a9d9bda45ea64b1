// A printed surface, simulated from what was sent: light of the layers (printed_light.h), added up over layers and
// cured as in print/cure.h, with the parts of cells that light reaches; tops cut at the membrane. Cells of half a
// pixel.
//
// Frame of the platform (manifest/sections/print.h), metres. Heights over the platform.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "explain/prints/printed_light.h"

namespace gonio::explain::prints {

struct Field {  // of cells, row by row from the smallest y
  int width = 0, height = 0;
  Vec2 corner_m{}, cell_m{};      // outer corner
  std::vector<double> top_m;      // 0 where nothing is solid
  std::vector<double> ceiling_m;  // of the layer that is seen
};
// What grows where the membrane leaves room, of a setting that displaces layers by whole cells.
Field grown(const Sent& sent, const Setting& setting, const Lights& lights);

// Layers are displaced by whole cells: by parts of a cell, areas are, and heights of the surfaces of whole ones are
// averaged. `grown_of` is asked for those.
using GrownOf = std::function<std::shared_ptr<const Field>(const Setting&)>;
std::shared_ptr<const Field> printed_field(const Sent& sent, const Setting& setting, const GrownOf& grown_of);
Field printed_field(const Sent& sent, const Setting& setting);
// The shift of a setting that grown_of() is asked for, in cells along x and y.
std::pair<int, int> shift_cells(const Sent& sent, const Setting& setting);

}  // namespace gonio::explain::prints
