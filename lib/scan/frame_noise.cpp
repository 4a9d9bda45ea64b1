// See frame_noise.h.
#include "scan/frame_noise.h"

#include <algorithm>
#include <cmath>

#include "stats/intervals.h"

namespace gonio::scan {
namespace {

constexpr std::size_t bins = 12, least_in_bin = 50, most_contradictions = 200000;

}  // namespace

manifest::Noise noise_of(std::vector<Contradiction> all) {
  std::erase_if(all, [](const Contradiction& c) { return !std::isfinite(c.light) || !std::isfinite(c.difference); });
  std::ranges::sort(all, {}, &Contradiction::light);
  const std::size_t count = std::max<std::size_t>(1, std::min(bins, all.size() / least_in_bin));
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t b = 0; b < count; ++b) {
    std::vector<double> sizes, lights;
    for (std::size_t i = b * all.size() / count; i < (b + 1) * all.size() / count; ++i)
      sizes.push_back(std::abs(all[i].difference)), lights.push_back(all[i].light);
    if (sizes.empty()) continue;
    const double sigma = stats::median(sizes) / 0.6745, x = std::max(0.0, stats::median(lights)), y = sigma * sigma;
    const double weight = 1 / std::max(1e-24, y * y);  // medians of variances have errors in proportion
    n += weight, sx += weight * x, sy += weight * y, sxx += weight * x * x, sxy += weight * x * y;
  }
  if (!(n > 0)) return {};
  const double spread = sxx - sx * sx / n;
  double slope = spread > 0 ? std::max(0.0, (sxy - sx * sy / n) / spread) : 0, level = (sy - slope * sx) / n;
  if (level < 0) level = 0, slope = sxy / sxx;  // the line that is nearest to them without one
  return {slope > 0 ? 1 / slope : 0, std::sqrt(level)};
}

std::vector<Contradiction> between_neighbours(const ValueOf& value, double unit, const ValueOf& light, int width,
                                              int height) {
  const auto columns = static_cast<std::size_t>(width);
  const int stride = std::max(3, static_cast<int>(columns * static_cast<std::size_t>(height) / most_contradictions));
  const auto scale = static_cast<float>(1 / (unit * std::sqrt(6.0)));
  std::vector<Contradiction> all;
  for (int y = 0; y < height; ++y)
    for (int x = 1 + y % stride; x + 1 < width; x += stride) {
      const std::size_t i = static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x);
      all.push_back({light(i), scale * (value(i - 1) - 2 * value(i) + value(i + 1))});
    }
  return all;
}

}  // namespace gonio::scan
