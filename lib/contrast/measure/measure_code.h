// The data matrix that the cells form. Private to contrast measure.
#pragma once
#include <optional>

#include "contrast/measure/measure.h"

namespace gonio::contrast {

// How modules stand in the cells: the code turned by quarter turns, and with 0 for 1.
struct Standing {
  int quarter_turns = 0;
  bool inverted = false;
};

// Replaces bits that were found in pictures by those of the code that they are, its errors corrected and its solid
// modules 1, where they can be read.
void settle_code(CellPattern& pattern);

// Reads the code from all views together and from each alone.
std::optional<MeasuredCode> measured_code(const Measured& result);

}  // namespace gonio::contrast
