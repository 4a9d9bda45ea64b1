// See odd_pictures.h.
#include "explain/stacks/odd_pictures.h"

#include <cmath>

#include "stats/intervals.h"

namespace gonio::explain::stacks {
namespace {

constexpr int sweeps = 10;

struct Level {
  std::size_t image = 0, site = 0;
  double value = 0;  // what is left of the logarithm
};

}  // namespace

std::vector<double> standing_out(const Stack& stack, const std::vector<Site>& sites) {
  std::vector<Level> levels;
  for (std::size_t s = 0; s < sites.size(); ++s)
    for (const std::size_t g : sites[s].seen) {
      const StackImage& image = stack.images[g];
      const int channel = sites[s].channel;
      const double y = stack.linear(channel, image.picture.at(sites[s].x, sites[s].y, channel));
      if (y > 0) levels.push_back({g, s, std::log(y / (image.exposure_s * image.gain))});
    }
  std::vector<double> out(stack.images.size());
  const auto sweep = [&](std::size_t Level::*key, std::size_t count) {
    std::vector<std::vector<double>> left(count);
    for (const Level& level : levels) left[level.*key].push_back(level.value);
    std::vector<double> middle(count);
    for (std::size_t k = 0; k < count; ++k) middle[k] = left[k].empty() ? 0 : stats::median(left[k]);
    for (Level& level : levels) level.value -= middle[level.*key];
    return middle;
  };
  for (int n = 0; n < sweeps; ++n) {
    sweep(&Level::site, sites.size());
    const std::vector<double> middle = sweep(&Level::image, out.size());
    for (std::size_t g = 0; g < out.size(); ++g) out[g] += middle[g];
  }
  const double common = stats::median(out);
  for (double& v : out) v -= common;
  return out;
}

}  // namespace gonio::explain::stacks
