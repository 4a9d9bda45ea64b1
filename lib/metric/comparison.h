// What distinguishes a rendering from a photograph, in numbers.
//
// With r the photograph, s the rendering, c the exposure scale, d = c s - r, over the N samples (channels of pixels)
// that count:
//
//   rmse           sqrt(mean d^2), in the photograph's unit
//   relative_rmse  rmse / sqrt(mean r^2)
//   log10_error    mean of log10 max(|d|, floor), floor = 1e-4 sqrt(mean r^2): no bright spot rules it
//   ssim           mean over channels and complete windows (ssim.h); data range: 1 for 8/16-bit files, else the
//                  99.9th percentile of the photograph, unless given
//   z              d / sigma, sigma^2 = c^2 var(s) + var(r); where noise alone differs, z_rms = sqrt(mean z^2) is 1
//                  and the share |z| > 3 is 0.27 %
//
// Standard errors: delete-one-block jackknife (Kunsch 1989) over the blocks of blocks.h, at the given c. They hold for
// scenes like this one: that some parts of a picture err more than others counts as spread, which noise alone would
// not show. A NaN or an infinity in a pixel that counts leaves every measure undefined.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metric/exposure.h"
#include "metric/overlay.h"

namespace gonio::metric {

struct Measures {
  std::int64_t pixels = 0, clipped = 0;
  Estimate exposure_scale{1, 0};
  bool exposure_fitted = false;
  std::optional<Estimate> rmse, relative_rmse, log10_error, ssim, z_rms, z_above_3;
  double mean_difference = 0;  // of d: the bias
  double photograph_rms = 0, data_range = 1, log_floor = 0;
  int block_px = 16;
  NotFinite not_finite;
};

// Per sample of the overlay; NaN where the sample does not count.
struct Differences {
  std::vector<float> signed_difference;  // d
  std::vector<float> z;                  // empty where no variance is known
};

struct MeasureOptions {
  Estimate exposure_scale{1, 0};
  bool exposure_fitted = false;
  std::optional<double> data_range;  // of SSIM
};
Measures measure(const Overlay& overlay, const MeasureOptions& options);
Differences differences(const Overlay& overlay, double exposure_scale);

// The user's limits; an absent measure that has a limit fails, and so does a NaN or an infinity whatever the limits.
struct Limits {
  std::optional<double> max_rmse{}, max_relative_rmse{}, max_log10_error{}, max_z_rms{}, min_ssim{};
};
std::vector<std::string> violations(const Measures& measures, const Limits& limits);  // in words; empty: passed

}  // namespace gonio::metric
