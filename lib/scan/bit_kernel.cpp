// See bit_kernel.h. Loops over whole blocks of plain arrays, which compilers turn into vector instructions.
#include "scan/bit_kernel.h"

#include <algorithm>
#include <cmath>

namespace gonio::scan {
namespace {

float positive(float v) {
  return v > 0 ? v : 0;
}

}  // namespace

void light_of(const CameraFrame& frame, std::size_t first, std::size_t count, Block<float>& light) {
  if (frame.codes.empty()) {
    std::copy_n(&frame.light[first], count, light.begin());
    return;
  }
  const std::uint8_t* const codes = &frame.codes[first];
  for (std::size_t i = 0; i < count; ++i) light[i] = frame.light_of_code[codes[i]];
}

void judge_bits(const BitBlock& read, const BitLimits& limits, bool has_inverse, BitVerdict& verdict) {
  const BitLimits l = limits;
  Block<float> inverse, difference;
  if (has_inverse)
    inverse = read.inverse;
  else
    for (std::size_t i = 0; i < pixels_of_block; ++i) inverse[i] = 0.5f * read.lit_and_dark[i];
  const float unit = has_inverse ? 1.0f : 2.0f;
  for (std::size_t i = 0; i < pixels_of_block; ++i) difference[i] = unit * (read.bit[i] - inverse[i]);
  for (std::size_t i = 0; i < pixels_of_block; ++i) {
    const float r = read.reflected[i], size = std::abs(difference[i]), own = l.share * r,
                variance = 2 * l.variance + l.slope * (positive(read.bit[i]) + positive(inverse[i]));
    verdict.edge[i] = static_cast<std::uint32_t>(size < l.difference) | static_cast<std::uint32_t>(size < own) |
                      static_cast<std::uint32_t>(size * size < l.squared_sigmas * variance);
    verdict.share[i] = difference[i] / (r > 0 ? r : 1e9f);
  }
  if (!has_inverse) return;
  for (std::size_t i = 0; i < pixels_of_block; ++i) {
    const float sum = read.bit[i] + inverse[i], off = std::abs(sum - read.lit_and_dark[i]),
                variance = 4 * l.variance + l.slope * (positive(sum) + positive(read.lit_and_dark[i])),
                least = std::min(l.moved_share * read.reflected[i],
                                 std::max(l.moved_least * read.reflected[i], std::abs(difference[i])));
    verdict.moved[i] = static_cast<std::uint32_t>(off > least) &
                       static_cast<std::uint32_t>(off * off > l.squared_moved_sigmas * variance);
  }
}

}  // namespace gonio::scan
