// Runs of pixels in Chitubox's archives (chitubox.h).
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "print/archive.h"

namespace gonio::print {

// Error(data) at `place` where runs end before or behind the last pixel.
void decode_grey_runs(std::string_view runs, std::span<std::uint8_t> picture, const std::string& place);
// One more on every pixel that is lit in this level set.
void count_level_set(std::string_view runs, std::span<std::uint8_t> counts, const std::string& place);
std::uint8_t grey_of_levels(std::size_t lit, std::size_t sets);

// Colours of 5 bits each, 16 bits a pixel or run.
std::string encode_preview(const JobPreview& preview);
void decode_preview(std::string_view runs, JobPreview& preview, const std::string& place);

// XOR with the key stream of a layer; undoes itself.
void turn_with_key(std::string& bytes, std::uint32_t key, std::uint32_t layer);

}  // namespace gonio::print
