// Bits of cells from their brightness, where the pattern is not known.
//
// In every view the cells' values, less the plane through all of them and over their spread, are
// clipped at 3; the first left singular vector of cells x views is what the cells have in common over the views,
// whatever sign each view gives it. It is cut in two where the variance within the two parts is least (Otsu 1979). Bit
// 1 is what is brighter in the views of the first placement, weighed by how clearly they show it.
#pragma once
#include <cstdint>
#include <vector>

#include "contrast/measure/pattern.h"
#include "contrast/measure/segmentation.h"

namespace gonio::contrast {

// `placement[v]`: 0 or 1. Empty where no two kinds of cells stand apart: the cut explains less than 0.7 of the
// variance (of a normal cloud, which has no kinds, it explains 2 / pi).
std::vector<std::uint8_t> split_cells(const CellPattern& pattern, const std::vector<const CellMeans*>& views,
                                      const std::vector<int>& placement);

}  // namespace gonio::contrast
