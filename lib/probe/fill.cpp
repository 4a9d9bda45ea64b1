// Pull: blocks of two by two, by solid angle. Push: bilinear from the coarser level where the finer one has nothing.
#include "probe/fill.h"

#include <cmath>
#include <vector>

#include "geom/vector.h"

namespace gonio::probe {
namespace {

struct Level {
  int width = 0, height = 0;
  std::vector<Rgb> value;
  std::vector<double> weight;
  std::size_t at(int x, int y) const {
    const int wrapped = ((x % width) + width) % width, row = y < 0 ? 0 : y >= height ? height - 1 : y;
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(wrapped);
  }
};

Level coarser(const Level& fine) {
  Level c{(fine.width + 1) / 2, (fine.height + 1) / 2, {}, {}};
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; ++x) {
      Rgb sum{};
      double weights = 0;
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
          if (2 * y + j >= fine.height || 2 * x + i >= fine.width) continue;
          const std::size_t k = fine.at(2 * x + i, 2 * y + j);
          const double w = fine.weight[k] * std::sin(pi * (2 * y + j + 0.5) / fine.height);
          sum += fine.value[k] * w, weights += w;
        }
      c.value.push_back(weights > 0 ? sum / weights : Rgb{});
      c.weight.push_back(weights > 0 ? 1 : 0);
    }
  return c;
}

void push(const Level& coarse, Level& fine) {
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t k = fine.at(x, y);
      if (fine.weight[k] > 0) continue;
      const double u = (x + 0.5) / 2 - 0.5, v = (y + 0.5) / 2 - 0.5;
      const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
      const double a = u - i, b = v - j;
      fine.value[k] = (coarse.value[coarse.at(i, j)] * (1 - a) + coarse.value[coarse.at(i + 1, j)] * a) * (1 - b) +
                      (coarse.value[coarse.at(i, j + 1)] * (1 - a) + coarse.value[coarse.at(i + 1, j + 1)] * a) * b;
      fine.weight[k] = 1;
    }
}

}  // namespace

void fill_unseen(io::Image& radiance, const io::Image& weight) {
  const std::size_t channels = weight.channels.size();
  std::vector<Level> levels(1, Level{radiance.width, radiance.height, {}, {}});
  double any = 0;
  for (std::size_t i = 0; i < radiance.pixels(); ++i) {
    const float* v = &radiance.data[3 * i];
    levels[0].value.push_back({v[0], v[1], v[2]});
    levels[0].weight.push_back(weight.data[i * channels] > 0 ? 1 : 0);
    any += levels[0].weight.back();
  }
  if (any == 0) return;
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(coarser(levels.back()));
  for (std::size_t l = levels.size() - 1; l-- > 0;) push(levels[l + 1], levels[l]);
  for (std::size_t i = 0; i < radiance.pixels(); ++i)
    if (!(weight.data[i * channels] > 0))
      for (int c = 0; c < 3; ++c)
        radiance.data[3 * i + static_cast<std::size_t>(c)] = static_cast<float>(levels[0].value[i][c]);
}

}  // namespace gonio::probe
