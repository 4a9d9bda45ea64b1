// Height maps of surfaces as instruments store them:
//   .sur  Digital Surf SURF, format 1: a 512-byte head, a comment, 16 or 32-bit integers; x and y along rows and
//   columns .opd  Wyko / Veeco Vision: a directory of named blocks; RAW_DATA holds heights in wavelengths, column after
//   column
//         from the lower left corner
//   .nms  NanoFocus usurf "OM_MS_2.0": a 3468-byte head, 16-bit integers between a lowest and a highest height
// Which one a file is says its beginning, not its name. Heights in metres, row after row from the top; NaN where the
// instrument measured nothing. Steps are those between neighbouring points of a row (x) and of a column (y).
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::io {

struct HeightMap {
  std::size_t width = 0, height = 0;
  double step_x_m = 0, step_y_m = 0;
  std::vector<double> z_m;
  double at(std::size_t x, std::size_t y) const { return z_m[y * width + x]; }
};

// Error(data | no_input). Lengths are checked against the file before anything is allocated.
HeightMap read_height_map(const std::filesystem::path& path);
HeightMap parse_height_map(std::string_view file, const std::string& place);
bool is_height_map(std::string_view beginning);  // 16 bytes suffice

// Digital Surf format 1, 32 bit, heights in steps of a 2^-30th of their range; for tests and for handing maps on.
void write_surf(const std::filesystem::path& path, const HeightMap& map);

// One reader per format; height_map.cpp chooses.
HeightMap parse_surf(std::string_view file, const std::string& place);
HeightMap parse_opd(std::string_view file, const std::string& place);
HeightMap parse_nms(std::string_view file, const std::string& place);

}  // namespace gonio::io
