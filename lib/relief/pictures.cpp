// See pictures.h.
#include "relief/pictures.h"

#include <algorithm>
#include <cmath>

#include "report/colour_map.h"

namespace gonio::relief {
namespace {

void paint(io::Image& image, int x, int y, report::Colour colour) {
  for (int c = 0; c < 3; ++c) image.at(x, y, c) = colour[static_cast<std::size_t>(c)];
}

}  // namespace

std::pair<double, double> range_of(const io::HeightMap& map) {
  double low = 1e300, high = -1e300;
  for (const double z : map.z_m)
    if (std::isfinite(z)) low = std::min(low, z), high = std::max(high, z);
  return {low, high};
}

io::Image picture_of(const io::HeightMap& map) {
  io::Image image(static_cast<int>(map.width), static_cast<int>(map.height), {"R", "G", "B"});
  const auto [low, high] = range_of(map);
  const double span = std::max(1e-300, high - low);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      paint(image, x, y,
            report::magnitude_colour((map.at(static_cast<std::size_t>(x), static_cast<std::size_t>(y)) - low) / span));
  return image;
}

io::Image picture_of(const LobeTable& lobe, double decades) {
  io::Image image(lobe.side, lobe.side, {"R", "G", "B"});
  double most = 0;
  for (const Estimate& e : lobe.picture) most = std::max(most, mean(e.value));
  for (int y = 0; y < lobe.side; ++y)
    for (int x = 0; x < lobe.side; ++x) {
      const double u = 2 * (x + 0.5) / lobe.side - 1, v = 2 * (y + 0.5) / lobe.side - 1;
      const double f = mean(lobe.picture[static_cast<std::size_t>(y * lobe.side + x)].value);
      const double t = decades > 0 ? (f > 0 ? 1 + std::log10(f / most) / decades : 0) : f / most;
      paint(image, x, y, u * u + v * v > 1 ? report::Colour{1, 1, 1} : report::magnitude_colour(t));
    }
  return image;
}

}  // namespace gonio::relief
