// See gaps.h.
#include "relief/gaps.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"

namespace gonio::relief {
namespace {

struct Gap {
  std::size_t at;
  double left, right, up, down;  // weights of the neighbours, 1 / step^2; 0 beyond the map
};

std::vector<Gap> gaps_of(const io::HeightMap& map) {
  const double wx = 1, wy = map.step_x_m * map.step_x_m / (map.step_y_m * map.step_y_m);
  std::vector<Gap> gaps;
  for (std::size_t y = 0; y < map.height; ++y)
    for (std::size_t x = 0; x < map.width; ++x)
      if (!std::isfinite(map.at(x, y)))
        gaps.push_back({y * map.width + x, x > 0 ? wx : 0, x + 1 < map.width ? wx : 0, y > 0 ? wy : 0,
                        y + 1 < map.height ? wy : 0});
  return gaps;
}

}  // namespace

std::size_t fill_gaps(io::HeightMap& map, const std::string& place) {
  const std::vector<Gap> gaps = gaps_of(map);
  if (gaps.empty()) return 0;
  if (2 * gaps.size() > map.z_m.size())
    throw Error(Exit::data, place,
                std::to_string(gaps.size()) + " of " + std::to_string(map.z_m.size()) + " points have no height",
                "at most half may be missing");
  double sum = 0, low = INFINITY, high = -INFINITY;
  for (const double z : map.z_m)
    if (std::isfinite(z)) sum += z, low = std::min(low, z), high = std::max(high, z);
  // From the last measured height of the row, which is near already.
  double last = sum / static_cast<double>(map.z_m.size() - gaps.size());
  for (double& z : map.z_m) {
    if (std::isfinite(z)) last = z;
    z = last;
  }
  constexpr double relaxation = 1.9;
  constexpr int most_sweeps = 2000;
  const double enough = 1e-6 * (high - low);
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double largest = 0;
    for (const Gap& g : gaps) {
      const std::size_t w = map.width;
      double pull = 0;
      if (g.left > 0) pull += g.left * map.z_m[g.at - 1];
      if (g.right > 0) pull += g.right * map.z_m[g.at + 1];
      if (g.up > 0) pull += g.up * map.z_m[g.at - w];
      if (g.down > 0) pull += g.down * map.z_m[g.at + w];
      const double change = relaxation * (pull / (g.left + g.right + g.up + g.down) - map.z_m[g.at]);
      map.z_m[g.at] += change;
      largest = std::max(largest, std::abs(change));
    }
    if (largest <= enough) break;
  }
  return gaps.size();
}

}  // namespace gonio::relief
