// Data matrices, ISO/IEC 16022 (ECC 200), by libdmtx: bits of modules to text and back.
//
// Modules are given row by row from the top, solid ones 1, the solid lines at the left and at the bottom. Only the data
// regions are read: the finder's own modules are known.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "contrast/measure/pattern.h"

namespace gonio::contrast {

bool matrix_size_exists(int rows, int columns);
std::string matrix_sizes();  // "10x10, 12x12, ..."

struct MatrixCode {
  std::string text;
  Bits modules;  // of the code after its errors were corrected, finder included
};
// Nothing where there are more errors than the code corrects.
std::optional<MatrixCode> read_matrix(const Bits& modules);
// The code that says `text`, as small as it goes (rows = 0) or of that size. Error(data) at `place` where it does not
// fit.
MatrixCode write_matrix(const std::string& text, int rows, int columns, const std::string& place);

// Share of the finder's modules (solid lines and clock tracks) that are as they must be.
double finder_share(const Bits& modules);

}  // namespace gonio::contrast
