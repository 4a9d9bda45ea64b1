// Three colours at every sample of a Bayer mosaic, with their variance (of polarizers: polarizers.h). Both ways are
// linear in the samples, so that the noise of each colour is the sum of weight^2 times variance; that neighbouring
// pixels share noise is not stated. Where the other colours bend by more than three times their noise within the reach
// of a mean, between samples of its own colour stands what nobody read: the square of that bend (the gradient's
// correction) is added to the variance of what is interpolated there.
//   bilinear   the mean of the nearest samples of a colour
//   gradient   bilinear, corrected by the Laplacian of the colour that was measured there: Malvar, He & Cutler 2004,
//              "High-quality linear interpolation for demosaicing of Bayer-patterned color images", gains 1/2, 5/8, 3/4
// Samples that cannot be trusted are left out of the means; where a corrected one would need them the plain mean
// stands. Borders: the samples that are there.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "io/image.h"
#include "photograph/mosaic.h"

namespace gonio::photograph {

enum class Demosaicing { bilinear, gradient };
inline constexpr std::array demosaicing_names{"bilinear", "gradient"};

struct MosaicSamples {
  int width = 0, height = 0;
  std::span<const float> value, variance;
  std::span<const std::uint8_t> trusted;
  // The shortest and the longest exposure that each sample is from, by any numbers that grow with it; empty: not known.
  std::span<const std::uint8_t> first{}, last{};
};

// Of exposures, by their numbers; first > last: none.
struct ExposureRange {
  std::uint8_t first = 255, last = 0;
  void add(ExposureRange other) { first = std::min(first, other.first), last = std::max(last, other.last); }
};
inline ExposureRange range_of(const MosaicSamples& samples, std::size_t i) {
  return samples.first.empty() ? ExposureRange{} : ExposureRange{samples.first[i], samples.last[i]};
}

struct Demosaiced {
  io::Image colour, variance;             // R, G, B; of Mono: Y; of polarizers: Y, s1.Y, s2.Y
  std::vector<std::uint8_t> trusted;      // its own sample, and one of each filter beside it
  std::vector<std::uint8_t> first, last;  // of all samples that a pixel's values are from; first > last: of none
};
Demosaiced demosaic(const MosaicSamples& samples, const Mosaic& mosaic, Demosaicing how);

}  // namespace gonio::photograph
