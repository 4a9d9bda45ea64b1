// From a picture to one mean per cell.
//
// A pixel belongs to a cell where the inverse mapping takes its centre into the cell's inner share; the strip that is
// left out keeps the neighbours' light and the error of the pose away. The mean's standard uncertainty is the scatter
// of the cell's pixels over the square root of their number, or that of the stated noise where this is larger. A cell
// that holds a saturated or a masked pixel, or fewer than min_pixels, does not count: its mean is NaN.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "contrast/measure/pattern.h"
#include "contrast/measure/view_map.h"

namespace gonio::contrast {

struct GreyView {  // linear radiance, one channel
  int width = 0, height = 0;
  std::vector<float> value;
  std::vector<float> variance;          // of noise, as it is stated; empty: not known
  std::vector<std::uint8_t> saturated;  // per pixel
  std::vector<std::uint8_t> counts;     // per pixel, by the mask; empty: all
};

struct CellMeans {
  std::vector<double> mean, sigma;  // NaN: the cell does not count
  std::vector<int> pixels;
  int saturated = 0, outside = 0, masked = 0, few = 0;  // cells that do not count, by the reason
  double cell_px = 0;                                   // shortest side of a cell in the picture
};

inline constexpr int min_pixels = 4;

CellMeans cell_means(const GreyView& view, const CellPattern& pattern, const ViewMap& map, double inner);

// Shortest side of any cell, in pixels, where the pattern lies in front of the camera.
std::optional<double> shortest_side_px(const CellPattern& pattern, const ViewMap& map);

}  // namespace gonio::contrast
