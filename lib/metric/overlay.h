// Photograph and rendering laid over each other: the samples that every measure walks over.
//
// Both are linear; the rendering is still without exposure scale. A sample is one channel of one pixel. A sample counts
// where the mask counts its pixel; NaN and infinities among those are an answer of their own and enter no measure.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "manifest/noise.h"
#include "photograph/linear_picture.h"
#include "photograph/mask.h"

namespace gonio::metric {

using photograph::LinearPicture, photograph::Mask;

enum class Channels { all, luminance, red, green, blue };
Channels channels_named(const std::string& name);  // "all", ...

struct NotFinite {
  std::int64_t pixels = 0;  // that count and hold a NaN or an infinity in either picture
  int x = -1, y = -1;       // the first of them in reading order
  std::string channel;
  bool in_photograph = false;
};

struct Overlay {
  std::string name;  // id of the image
  int width = 0, height = 0;
  std::vector<std::string> channels;
  std::vector<float> photograph, rendering;                    // channels.size() a pixel
  std::vector<float> photograph_variance, rendering_variance;  // empty: not known
  std::optional<manifest::Noise> noise;                        // of the photograph: variance v / gain + read^2
  std::vector<std::uint8_t> counts;                            // per pixel: in the mask, and finite in both pictures
  std::vector<std::uint8_t> clipped;  // per pixel: kept out of the exposure fit and the z-scores
  bool integer_codes = false;
  std::int64_t pixels = 0;  // that count
  NotFinite not_finite;

  // Variance of (scale * rendering - photograph) in sample i under the hypothesis that the rendering is right; NaN
  // where it is not known. The photograph's noise follows the predicted value, which noise itself has not bent.
  double variance(std::size_t i, double scale) const;
  bool knows_variance() const { return noise.has_value() || !photograph_variance.empty(); }
};

// `mask` may be a null pointer. Colour against grey is compared as luminance (0.2126 R + 0.7152 G + 0.0722 B, Rec.
// 709). Error(data) for different sizes, a mask that counts nothing, a channel that is not there.
Overlay lay_over(std::string name, LinearPicture photograph, LinearPicture rendering, const Mask* mask,
                 Channels channels, std::optional<manifest::Noise> noise);

}  // namespace gonio::metric
