// What a bit of a Gray code and its inverse say of each pixel, many pixels at once. For this room.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "scan/decode.h"

namespace gonio::scan {

constexpr std::size_t pixels_of_block = 1024;

template <class Number>
using Block = std::array<Number, pixels_of_block>;

// `count` pixels from `first` on; what lies beyond is left as it was.
void light_of(const CameraFrame& frame, std::size_t first, std::size_t count, Block<float>& light);

struct BitLimits {
  float difference = 0;           // least of |bit - inverse|
  float share = 0;                // the same, of what white adds
  float squared_sigmas = 0;       // the same squared, of its variance
  float variance = 0, slope = 0;  // of a reading: in the dark, and per light
  // Of what bit and inverse differ by from white and black: the least, of what white adds, that could have turned a
  // bit; what says that something else stands there; and of its noise.
  float moved_least = 0, moved_share = 0, squared_moved_sigmas = 0;
};

struct BitBlock {
  Block<float> bit{}, inverse{};
  Block<float> reflected{}, lit_and_dark{};  // white - black, white + black
};

struct BitVerdict {
  Block<float> share{};         // (bit - inverse) / reflected, 0 where nothing is reflected
  Block<std::uint32_t> edge{};  // 1: less than the limits
  // 1: bit and inverse do not add up to white and black, which nothing that stands still can do: whatever light the
  // scene sends on, all of the projector's pixels are lit once in both sums.
  Block<std::uint32_t> moved{};
};

// What is known of the pixels of a block, and where: null pointers where nothing is kept.
struct BitNotes {
  std::uint32_t* gray = nullptr;
  Refusal* refusal = nullptr;
  std::uint8_t *least_share = nullptr, *direct_share = nullptr;  // in units of share_unit
  bool refuse_moved = false;
};
constexpr float share_unit = 1 / 200.f;
void note_bits(const BitVerdict& verdict, int bit, std::size_t count, const BitNotes& notes);

// Without an inverse, `bit` is compared with the mean of white and black, and nothing tells what moved.
void judge_bits(const BitBlock& read, const BitLimits& limits, bool has_inverse, BitVerdict& verdict);

}  // namespace gonio::scan
