// Height maps of surfaces as instruments store them:
//   .sur  Digital Surf SURF, format 1: a 512-byte head, a comment, 16 or 32-bit integers; x and y along rows and
//         columns
//   .opd  Wyko / Veeco Vision: a directory of named blocks; RAW_DATA holds heights in wavelengths, column after column
//         from the lower left corner
//   .nms  NanoFocus usurf "OM_MS_2.0": a 3468-byte head, 16-bit integers between a lowest and a highest height
//   .x3p  ISO 25178-72: a zip archive of main.xml and a binary matrix, row after row, metres
//   .plu  Sensofar PLu: a 500-byte head that begins with a date, 32-bit floats, um
//   OpenEXR, TIFF (32-bit floats or 16-bit codes): pictures, which do not say what a pixel is: HeightPicture does
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

// What a picture's numbers mean. An OpenEXR that write_height_map() wrote says so itself, in its texts step_x_m and
// step_y_m. Codes of 16 bits: 0 to 65535 times the unit.
struct HeightPicture {
  double step_x_m = 0, step_y_m = 0;  // 0: the file's own; needed where it has none
  double unit_m = 0;                  // 0: OpenEXR metres; needed for TIFF
  std::string channel{};              // of several; empty: the only one, or Z
};

// Error(data | no_input). Lengths are checked against the file before anything is allocated.
HeightMap read_height_map(const std::filesystem::path& path, const HeightPicture& picture = {});
HeightMap parse_height_map(std::string_view file, const std::string& place, const HeightPicture& picture = {});
// Files that describe themselves, pictures not among them; height_map_beginning bytes suffice.
inline constexpr std::size_t height_map_beginning = 32;
bool is_height_map(std::string_view beginning);
bool is_height_picture(std::string_view beginning);  // OpenEXR or TIFF, by whatever it shows

// Digital Surf format 1, 32 bit, heights in steps of a 2^-30th of their range; for tests and for handing maps on.
void write_surf(const std::filesystem::path& path, const HeightMap& map);
// ISO 25178-72, 64-bit floats, NaN where nothing was measured.
void write_x3p(const std::filesystem::path& path, const HeightMap& map);
// By extension: .sur, .x3p, .exr (32-bit floats, channel Z). Error(usage) for others.
void write_height_map(const std::filesystem::path& path, const HeightMap& map);
bool writes_height_map(const std::filesystem::path& path);

// One reader per format; height_map.cpp chooses.
HeightMap parse_surf(std::string_view file, const std::string& place);
HeightMap parse_opd(std::string_view file, const std::string& place);
HeightMap parse_nms(std::string_view file, const std::string& place);
HeightMap parse_x3p(std::string_view file, const std::string& place);
bool is_plu(std::string_view beginning);
HeightMap parse_plu(std::string_view file, const std::string& place);
HeightMap parse_height_picture(std::string_view file, const std::string& place, const HeightPicture& picture);
void write_height_picture(const std::filesystem::path& path, const HeightMap& map);

}  // namespace gonio::io
