// A first look at what the base model leaves, before any fit: relative residuals after one brightness for each image,
// surface and colour. Starts of searches come from it, never verdicts.
#pragma once
#include "relighting/term.h"

namespace gonio::relighting {

struct RoughResidual {
  struct Sight {  // a pixel that shows one surface alone, lit enough to be divided by
    std::size_t image = 0, facet = 0;
    std::uint32_t surface = 0, pixel = 0;
    double expected = 0;  // by the scaled prediction, mean of the colours
    double relative = 0;  // observed over predicted, less 1; mean of the colours
  };
  std::vector<Sight> sights;
};
RoughResidual rough_residual(const Setting& setting);

}  // namespace gonio::relighting
