// See grid_regions.h.
#include "explain/stacks/grid_regions.h"

#include <algorithm>

namespace gonio::explain::stacks {

std::vector<GridRegion> grid_regions(const std::vector<std::uint8_t>& counts, int width, int height,
                                     std::size_t least) {
  std::vector<std::uint8_t> seen(counts.size());
  std::vector<GridRegion> found;
  for (std::size_t start = 0; start < counts.size(); ++start) {
    if (!counts[start] || seen[start]) continue;
    GridRegion region{{start}, width, height, 0, 0};
    seen[start] = 1;
    for (std::size_t k = 0; k < region.points.size(); ++k) {
      const int x = static_cast<int>(region.points[k]) % width, y = static_cast<int>(region.points[k]) / width;
      region.left = std::min(region.left, x), region.right = std::max(region.right, x);
      region.top = std::min(region.top, y), region.bottom = std::max(region.bottom, y);
      for (int b = std::max(0, y - 1); b <= std::min(height - 1, y + 1); ++b)
        for (int a = std::max(0, x - 1); a <= std::min(width - 1, x + 1); ++a) {
          const auto at = static_cast<std::size_t>(b * width + a);
          if (counts[at] && !seen[at]) seen[at] = 1, region.points.push_back(at);
        }
    }
    if (region.points.size() >= least) found.push_back(std::move(region));
  }
  std::ranges::stable_sort(found, std::ranges::greater{}, [](const GridRegion& r) { return r.points.size(); });
  return found;
}

}  // namespace gonio::explain::stacks
