// Wyko / Veeco Vision files. After two bytes a directory of entries of 24 bytes: name (16), type, length in bytes,
// attribute; the first entry is the directory's own. The blocks follow in its order. RAW_DATA (or RAW DATA): columns,
// rows and bytes per point as 16-bit integers, then the points column after column from the lower left: integers (2)
// are fringes times Mult, floats (4) fringes, where a fringe is Wavelength, nm. Pixel_size is the step along x, mm; the
// step along y is Aspect times as long.
#include <limits>
#include <map>
#include <optional>

#include "io/height_map.h"
#include "io/height_map_checks.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

constexpr std::size_t entry_bytes = 24, most_entries = 4096;
constexpr double bad_float = 1e10;  // what was not measured is stored as some 1e38

struct Block {
  int type = 0;
  std::size_t first = 0, bytes = 0;
};
using Directory = std::map<std::string, Block>;

Directory directory_of(std::string_view file, const std::string& place) {
  check_map_bytes(file.size(), 2 + entry_bytes, place);
  const auto own = stored_at<std::int32_t>(file, 2 + 18);
  if (own < static_cast<std::int32_t>(entry_bytes) || own > static_cast<std::int32_t>(most_entries * entry_bytes))
    refuse_map(place, "claims a directory of " + std::to_string(own) + " bytes");
  const std::size_t entries = static_cast<std::size_t>(own) / entry_bytes;
  check_map_bytes(file.size(), 2 + entries * entry_bytes, place);
  Directory directory;
  std::size_t next = 2 + static_cast<std::size_t>(own);
  for (std::size_t i = 1; i < entries; ++i) {
    const std::size_t at = 2 + i * entry_bytes;
    std::string name(file.substr(at, 16));
    name = name.substr(0, name.find('\0'));
    const auto bytes = stored_at<std::int32_t>(file, at + 18);
    if (bytes < 0) refuse_map(place, "claims that block \"" + name + "\" has a negative length");
    if (!name.empty() && bytes > 0)
      directory.try_emplace(name, Block{stored_at<std::int16_t>(file, at + 16), next, static_cast<std::size_t>(bytes)});
    next += static_cast<std::size_t>(bytes);
    if (next > file.size() && bytes > 0 && !name.empty()) directory.erase(name);  // cut off, or never written
  }
  return directory;
}

// Types: 6 a 16-bit integer, 7 a float, 8 a double, 12 a 32-bit integer.
std::optional<double> number(std::string_view file, const Directory& directory, const char* name) {
  const auto found = directory.find(name);
  if (found == directory.end()) return {};
  const Block& b = found->second;
  if (b.type == 6 && b.bytes >= 2) return stored_at<std::int16_t>(file, b.first);
  if (b.type == 7 && b.bytes >= 4) return static_cast<double>(stored_at<float>(file, b.first));
  if (b.type == 8 && b.bytes >= 8) return stored_at<double>(file, b.first);
  if (b.type == 12 && b.bytes >= 4) return stored_at<std::int32_t>(file, b.first);
  return {};
}

}  // namespace

HeightMap parse_opd(std::string_view file, const std::string& place) {
  const Directory directory = directory_of(file, place);
  auto raw = directory.find("RAW_DATA");
  if (raw == directory.end()) raw = directory.find("RAW DATA");
  if (raw == directory.end()) refuse_map(place, "has no block RAW_DATA within its length");
  const Block& block = raw->second;
  check_map_bytes(block.bytes, 6, place);
  const auto width = stored_at<std::uint16_t>(file, block.first),
             height = stored_at<std::uint16_t>(file, block.first + 2),
             bytes = stored_at<std::uint16_t>(file, block.first + 4);
  check_map_size(width, height, place);
  if (bytes != 2 && bytes != 4) refuse_map(place, "has points of " + std::to_string(bytes) + " bytes, not 2 or 4");
  check_map_bytes(block.bytes, 6 + std::size_t{width} * height * bytes, place);
  const std::optional<double> wavelength = number(file, directory, "Wavelength"),
                              mult = number(file, directory, "Mult"), pixel = number(file, directory, "Pixel_size"),
                              aspect = number(file, directory, "Aspect");
  if (!wavelength || !(*wavelength > 0 && *wavelength < 1e6)) refuse_map(place, "states no Wavelength");
  if (bytes == 2 && !(mult && *mult != 0)) refuse_map(place, "states no Mult for its integers");
  const double fringe_m = *wavelength * 1e-9 / (bytes == 2 ? *mult : 1);

  HeightMap map{width, height, 0, 0, std::vector<double>(std::size_t{width} * height)};
  map.step_x_m = checked_step(pixel.value_or(0) * 1e-3, "x", place);
  map.step_y_m = checked_step(map.step_x_m * aspect.value_or(1), "y", place);
  for (std::size_t x = 0, i = 0; x < map.width; ++x)
    for (std::size_t up = 0; up < map.height; ++up, ++i) {
      const std::size_t at = block.first + 6 + i * bytes;
      const double value =
          bytes == 2 ? stored_at<std::int16_t>(file, at) : static_cast<double>(stored_at<float>(file, at));
      const bool bad = bytes == 2 ? value == 32767 : !(std::abs(value) < bad_float);
      map.z_m[(map.height - 1 - up) * map.width + x] =
          bad ? std::numeric_limits<double>::quiet_NaN() : value * fringe_m;
    }
  return map;
}

}  // namespace gonio::io
