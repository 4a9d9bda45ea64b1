// Pictures of archives (archive.h) as PNG files.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "print/archive.h"

namespace gonio::print {

std::string png_of_layer(const Job& job, std::span<const std::uint8_t> picture);
// Sides of a PNG, of its beginning alone. Error(data).
void read_png_sides(std::string_view beginning, const std::string& place, int& width_px, int& height_px);
// A layer of the job's size; Error(data) for another. Colours become their luminance; 16 bits are refused.
void read_png_layer(const std::string& png, const Job& job, const std::string& place, std::span<std::uint8_t> to);
// The most bytes that the file of such a picture takes.
std::uint64_t most_png_bytes(const Job& job);

std::string png_of_preview(const JobPreview& preview);
JobPreview read_png_preview(const std::string& png, const std::string& place);

}  // namespace gonio::print
