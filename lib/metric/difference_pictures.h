// Pictures of a comparison for people: what the two look like, where they differ, which way, and by how many orders.
//
// All are 8-bit display pictures (codes / 255 in sRGB) except the numbers' own planes. `white` is always stated beside
// the picture: it is the linear value that full brightness or full colour stands for.
#pragma once
#include <array>

#include "io/image.h"
#include "metric/comparison.h"

namespace gonio::metric {

struct DisplayTone {
  double white = 1;                        // linear radiance shown as white: the 99.5th percentile of the photograph
  double difference = 1;                   // |d| shown at full brightness or colour: the 99.5th percentile of |d|
  std::array<double, 2> log_range{-4, 0};  // log10 |d| at the ends of the scale: the floor, and the largest |d|
};
DisplayTone display_tone(const Overlay& overlay, const Differences& d, const Measures& m);

enum class Which { photograph, rendering };
io::Image display(const Overlay& overlay, Which which, double exposure_scale, double white);  // sRGB curve

// max(d, 0) and max(-d, 0), per channel, over `white`, gamma 2.2: where the rendering is too bright, and where too
// dark.
io::Image positive_part(const Overlay& overlay, const Differences& d, double white);
io::Image negative_part(const Overlay& overlay, const Differences& d, double white);

// Mean of d over the channels on a blue (too dark) - white - red (too bright) scale; grey where nothing counts.
io::Image signed_map(const Overlay& overlay, const Differences& d, double white);
// log10 of the mean |d| over the channels, in viridis; grey where nothing counts, magenta where not finite.
io::Image log_map(const Overlay& overlay, const Differences& d, const DisplayTone& tone, double floor);
// Mean of z over the channels times sqrt(channels) (of unit variance under noise alone), +-4 at full colour.
io::Image z_map(const Overlay& overlay, const Differences& d);

// The numbers themselves: difference.R, ..., and z.R, ... where known. NaN where nothing counts.
io::Image difference_planes(const Overlay& overlay, const Differences& d);

}  // namespace gonio::metric
