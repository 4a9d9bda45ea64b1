// See bit_kernel.h. Loops over whole blocks of plain arrays, which compilers turn into vector instructions.
#include "scan/bit_kernel.h"

#include <algorithm>
#include <cmath>

// The same code for processors with wider registers, chosen when the program starts; no operation is another.
#define GONIO_WIDE __attribute__((target_clones("avx2", "default")))

namespace gonio::scan {
namespace {

float positive(float v) {
  return v > 0 ? v : 0;
}

// Of a whole block.
GONIO_WIDE void note_shares(const BitVerdict& verdict, std::uint8_t* least, std::uint8_t* direct) {
  Block<std::uint8_t> shares;
  for (std::size_t i = 0; i < pixels_of_block; ++i)
    shares[i] =
        static_cast<std::uint8_t>(static_cast<int>(std::min(std::abs(verdict.share[i]), 1.2f) / share_unit + 0.5f));
  for (std::size_t i = 0; least != nullptr && i < pixels_of_block; ++i) least[i] = std::min(least[i], shares[i]);
  if (direct != nullptr) std::copy_n(shares.begin(), pixels_of_block, direct);
}

GONIO_WIDE void note_codes(const BitVerdict& verdict, int bit, std::uint32_t* gray) {
  for (std::size_t i = 0; i < pixels_of_block; ++i) gray[i] |= static_cast<std::uint32_t>(verdict.share[i] > 0) << bit;
}

GONIO_WIDE void note_refusals(const BitVerdict& verdict, std::uint32_t moves, Refusal* refusal) {
  auto* const own = reinterpret_cast<std::uint8_t*>(refusal);
  constexpr auto none = static_cast<std::uint8_t>(Refusal::none), edge = static_cast<std::uint8_t>(Refusal::edge),
                 motion = static_cast<std::uint8_t>(Refusal::motion);
  for (std::size_t i = 0; i < pixels_of_block; ++i) {
    const std::uint8_t with_edge = verdict.edge[i] != 0 && own[i] == none ? edge : own[i];
    const bool open = with_edge == none || with_edge == edge;
    own[i] = (verdict.moved[i] & moves) != 0 && open ? motion : with_edge;
  }
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

GONIO_WIDE void judge_bits(const BitBlock& read, const BitLimits& limits, bool has_inverse, BitVerdict& verdict) {
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

void note_bits(const BitVerdict& verdict, int bit, std::size_t count, const BitNotes& notes) {
  Block<std::uint32_t> gray;
  Block<Refusal> refusal;
  Block<std::uint8_t> least, direct;
  const bool whole = count == pixels_of_block;
  if (!whole) {  // the last ones of a picture, in blocks of their own
    std::copy_n(notes.gray, count, gray.begin()), std::copy_n(notes.refusal, count, refusal.begin());
    if (notes.least_share != nullptr) std::copy_n(notes.least_share, count, least.begin());
  }
  note_codes(verdict, bit, whole ? notes.gray : gray.data());
  note_refusals(verdict, notes.refuse_moved ? 1 : 0, whole ? notes.refusal : refusal.data());
  if (notes.least_share != nullptr || notes.direct_share != nullptr)
    note_shares(verdict,
                notes.least_share == nullptr ? nullptr
                : whole                      ? notes.least_share
                                             : least.data(),
                notes.direct_share == nullptr ? nullptr
                : whole                       ? notes.direct_share
                                              : direct.data());
  if (whole) return;
  std::copy_n(gray.begin(), count, notes.gray), std::copy_n(refusal.begin(), count, notes.refusal);
  if (notes.least_share != nullptr) std::copy_n(least.begin(), count, notes.least_share);
  if (notes.direct_share != nullptr) std::copy_n(direct.begin(), count, notes.direct_share);
}

}  // namespace gonio::scan
