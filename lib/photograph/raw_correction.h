// What a sensor adds to the light and takes from it, from frames that show it alone.
//   dark frames   x = offset + rate t in the dark, sample by sample: what is left of black, and dark current
//   flat frames   of an even light: sensitivity and shading of each sample, relative to its colour's mean
// A sample whose dark current stands far out (hot), or that sees next to nothing of the even light (dead), is unusable.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "photograph/raw_frame.h"

namespace gonio::photograph {

struct DarkField {
  std::vector<float> offset, rate_per_s;  // codes, codes per second
  std::vector<std::uint8_t> hot;
  std::size_t frames = 0;
  float at(std::size_t i, float exposure_s) const { return offset[i] + rate_per_s[i] * exposure_s; }  // codes
};
// Frames of one duration alone, or of none that is known: all of it is taken for dark current, or for the offset.
// Error(data) for frames of different sizes.
DarkField dark_field(const std::vector<std::filesystem::path>& frames, const RawStated& stated);

struct FlatField {
  std::vector<float> factor, variance;  // what a sample is multiplied by, and the relative variance of that
  std::vector<std::uint8_t> dead;
  std::size_t frames = 0;
};
// `dark`: taken off before. Saturated samples are refused: Error(data).
FlatField flat_field(const std::vector<std::filesystem::path>& frames, const RawStated& stated,
                     const std::optional<DarkField>& dark);

// Dark current and offset off a frame's codes.
void take_off(const DarkField& dark, double exposure_s, std::vector<float>& codes);

}  // namespace gonio::photograph
