// See layer_steps.h.
#include "explain/traced/layer_steps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::explain::traced {
namespace {

constexpr double thickest = 0.34, finer = 1.02, thinnest = 0.012;  // of the height that is seen
constexpr int places = 16;                                         // of the first layer, over two layers

// Least squares of r by the columns, weights within; what it takes off the squares.
double taken_off(const std::vector<std::array<double, 3>>& columns, const std::vector<double>& r) {
  double a[3][3] = {}, b[3] = {};
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      b[j] += columns[i][j] * r[i];
      for (std::size_t k = 0; k < 3; ++k) a[j][k] += columns[i][j] * columns[i][k];
    }
  double gain = 0;
  for (std::size_t j = 0; j < 3; ++j) {  // elimination by columns: each takes its own share
    if (!(a[j][j] > 1e-12)) continue;
    gain += b[j] * b[j] / a[j][j];
    for (std::size_t k = j + 1; k < 3; ++k) {
      const double f = a[j][k] / a[j][j];
      b[k] -= f * b[j];
      for (std::size_t m = j + 1; m < 3; ++m) a[k][m] -= f * a[j][m];
    }
  }
  return gain;
}

}  // namespace

LayerSteps find_layers(const TracedModel& model, std::size_t surface, const Observations& o) {
  std::vector<double> r, height, slope, level;
  const Sampled& sampled = model.sampled();
  for (std::size_t p = 0; p < sampled.pixels.size(); ++p) {
    if (sampled.pixels[p].surface != surface) continue;
    for (std::size_t row = 3 * p; row < 3 * p + 3; ++row) {
      const double f = model.stated().radiance[row];
      r.push_back((o.value[row] - f) / o.sigma[row]), level.push_back(f / o.sigma[row]);
      slope.push_back(model.slope_of_roughness(surface, row) / o.sigma[row]);
      height.push_back(sampled.pixels[p].here.position_m.z);
    }
  }
  LayerSteps best;
  if (r.size() < 30) return best;
  const auto [low, high] = std::ranges::minmax(height);
  double most = -1;
  std::vector<std::array<double, 3>> columns(r.size());
  for (double layer = thickest * (high - low); layer > thinnest * (high - low); layer /= finer)
    for (int place = 0; place < places; ++place) {
      const double offset = 2 * layer * place / places;
      for (std::size_t i = 0; i < r.size(); ++i) {
        const bool odd = std::fmod(std::floor((height[i] - offset) / layer) + 1e6, 2.0) != 0;
        columns[i] = {level[i], slope[i], odd ? slope[i] : 0};
      }
      const double gain = taken_off(columns, r);
      if (gain > most) most = gain, best = {layer, offset};
    }
  return best;
}

}  // namespace gonio::explain::traced
