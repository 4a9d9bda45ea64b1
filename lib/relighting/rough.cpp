#include "relighting/rough.h"

#include <algorithm>
#include <cmath>

#include "relighting/image_model.h"

namespace gonio::relighting {
namespace {

constexpr double least_share = 0.05;  // of the picture's mean: darker pixels divide noise by nothing

struct Scale {
  double observed = 0, predicted = 0;
};

}  // namespace

RoughResidual rough_residual(const Setting& s) {
  RoughResidual result;
  for (std::size_t g = 0; g < s.recordings.images.size(); ++g) {
    const Recording& image = s.recordings.images[g];
    const ViewCache& cache = s.model.cache(image.view);
    std::vector<std::uint32_t> picked;
    for (std::uint32_t p = 0; p < cache.pixels.size(); ++p) {
      const Pixel& pixel = cache.pixels[p];
      const auto place = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(image.picture.width) +
                         static_cast<std::size_t>(pixel.x);
      if (image.counts[place] && pixel.facets == 1 && pixel.sky == 0) picked.push_back(p);
    }
    std::vector<double> predicted(3 * picked.size());
    s.model.predict(s.model.layout().start, g, picked, predicted);
    std::vector<std::array<Scale, 3>> scales(s.layout.surfaces.size());
    const auto observed = [&](std::uint32_t p, std::size_t c) {
      return double{image.picture.at(cache.pixels[p].x, cache.pixels[p].y, static_cast<int>(c))};
    };
    for (std::size_t i = 0; i < picked.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        Scale& scale = scales[cache.facets[cache.pixels[picked[i]].first_facet].surface][c];
        scale.observed += observed(picked[i], c);
        scale.predicted += predicted[3 * i + c];
      }
    for (std::size_t i = 0; i < picked.size(); ++i) {
      const std::size_t f = cache.pixels[picked[i]].first_facet;
      const std::uint32_t surface = cache.facets[f].surface;
      double sum = 0, level = 0, n = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const Scale& scale = scales[surface][c];
        if (!(scale.predicted > 0)) continue;
        const double expected = predicted[3 * i + c] * scale.observed / scale.predicted;
        if (!(expected > least_share * image.mean[static_cast<int>(c)])) continue;
        sum += observed(picked[i], c) / expected - 1;
        level += expected;
        n += 1;
      }
      if (n > 0) result.sights.push_back({g, f, surface, picked[i], level / n, sum / n});
    }
  }
  return result;
}

}  // namespace gonio::relighting
