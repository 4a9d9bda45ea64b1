#include "relighting/fixed_pattern.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonio::relighting {
namespace {

constexpr double least_share = 0.05;  // of the picture's mean: darker pixels divide noise by nothing
constexpr double most_sigmas = 3.5;   // of the slope and the bend across a pixel's neighbours
constexpr double neighbours = 8;
constexpr double patterns_own = 0.03;  // relative differences of neighbours that a pattern itself may make

std::size_t at(const io::Image& picture, int x, int y, int c) {
  return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x)) +
         static_cast<std::size_t>(c);
}

struct Deviation {
  double value = 0, variance = 0;
  bool known = false;
};

// Are all nine counted, and is the surface under them even? Means of opposite rows and columns may differ by what noise
// and a pattern do, and so may the ring's sides and its corners.
Deviation deviation(const Recording& image, int x, int y, int c) {
  const io::Image& picture = image.picture;
  double v[3][3], sum = 0;
  for (int b = 0; b < 3; ++b)
    for (int a = 0; a < 3; ++a) {
      const std::size_t i = at(picture, x + a - 1, y + b - 1, c);
      if (!image.counts[i / 3] || !std::isfinite(picture.data[i])) return {};
      v[b][a] = picture.data[i];
      sum += v[b][a];
    }
  const double mean = (sum - v[1][1]) / neighbours;
  if (!(mean > least_share * image.mean[c])) return {};
  const double noise = noise_sigma(image, mean), single = std::hypot(noise, patterns_own * mean);
  const double across = (v[0][2] + v[1][2] + v[2][2] - v[0][0] - v[1][0] - v[2][0]) / 3;
  const double down = (v[2][0] + v[2][1] + v[2][2] - v[0][0] - v[0][1] - v[0][2]) / 3;
  const double bend = (v[0][1] + v[1][0] + v[1][2] + v[2][1] - v[0][0] - v[0][2] - v[2][0] - v[2][2]) / 4;
  const double limit = most_sigmas * single;
  if (std::abs(across) > limit * std::sqrt(2.0 / 3) || std::abs(down) > limit * std::sqrt(2.0 / 3) ||
      std::abs(bend) > limit * std::sqrt(0.5))
    return {};
  return {v[1][1] / mean - 1, noise * noise / (mean * mean) * (1 + 1 / neighbours), true};
}

// Does view v learn from view w? Each pair in one direction: from the half of the views that follow, in a circle.
bool learns(std::size_t v, std::size_t w, std::size_t views) {
  if (v == w) return false;
  const std::size_t ahead = (w + views - v) % views;
  return 2 * ahead < views || (2 * ahead == views && v < w);
}

}  // namespace

FixedPattern fixed_pattern(const Recordings& recordings) {
  FixedPattern result;
  const std::size_t views = recordings.views.size();
  for (std::size_t v = 0; v < views; ++v) {
    const int width = recordings.views[v].model.width_px(), height = recordings.views[v].model.height_px();
    const auto values = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3;
    std::vector<double> sum(values), weight(values);
    FixedPattern::OfView own;
    for (const Recording& image : recordings.images) {
      if (!learns(v, image.view, views) || recordings.views[image.view].camera != recordings.views[v].camera) continue;
      for (int y = 1; y + 1 < height; ++y)
        for (int x = 1; x + 1 < width; ++x)
          for (int c = 0; c < 3; ++c) {
            const Deviation d = deviation(image, x, y, c);
            if (!d.known || !(d.variance > 0)) continue;
            sum[at(image.picture, x, y, c)] += d.value / d.variance;
            weight[at(image.picture, x, y, c)] += 1 / d.variance;
          }
    }
    own.deviation.assign(values, std::numeric_limits<float>::quiet_NaN());
    own.variance.assign(values, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < values; ++i) {
      if (!(weight[i] > 0)) continue;
      own.deviation[i] = static_cast<float>(sum[i] / weight[i]);
      own.variance[i] = static_cast<float>(1 / weight[i]);
      own.any = true;
    }
    result.views.push_back(std::move(own));
  }
  return result;
}

}  // namespace gonio::relighting
