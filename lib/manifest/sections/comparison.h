// "comparisons": of photographs with renderings.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "manifest/parameter.h"
#include "manifest/value.h"

namespace gonio::manifest {

struct Comparison {  // "comparisons"
  std::string image;
  std::optional<double> exposure_scale, rmse, relative_rmse, ssim, log10_error, z_rms;
  std::optional<double> z_above_3;  // share of |z| > 3
  std::optional<std::int64_t> pixels, not_finite;
  Sigmas sigma;
  Value files;  // {"report": file id, ...}
};

}  // namespace gonio::manifest
