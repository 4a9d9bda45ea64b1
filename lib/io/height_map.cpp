// See height_map.h.
#include "io/height_map.h"

#include "base/atomic_file.h"
#include "io/height_map_checks.h"

namespace gonio::io {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view surf = "DIGITAL SURF", zip = "PK\x03\x04", exr = "\x76\x2f\x31\x01", tiff_low = "II\x2a\0"sv,
                           tiff_high = "MM\0\x2a"sv;
constexpr std::string_view opd =
    "\x01\x00"
    "Directory"sv;

bool is_nms(std::string_view file) {
  return file.size() >= 16 && file.substr(0, 8) == "\x02\x00\x00\x00\x01\x00\x00\x00"sv;
}

}  // namespace

bool is_height_map(std::string_view beginning) {
  return beginning.starts_with(surf) || beginning.starts_with(opd) || beginning.starts_with(zip) || is_nms(beginning) ||
         is_plu(beginning);
}

bool is_height_picture(std::string_view beginning) {
  return beginning.starts_with(exr) || beginning.starts_with(tiff_low) || beginning.starts_with(tiff_high);
}

HeightMap parse_height_map(std::string_view file, const std::string& place, const HeightPicture& picture) {
  if (file.starts_with(surf)) return parse_surf(file, place);
  if (file.starts_with(opd)) return parse_opd(file, place);
  if (file.starts_with(zip)) return parse_x3p(file, place);
  if (is_nms(file)) return parse_nms(file, place);
  if (is_plu(file)) return parse_plu(file, place);
  if (is_height_picture(file)) return parse_height_picture(file, place, picture);
  refuse_map(place, "is no height map that gonio reads: it begins like none of them");
}

HeightMap read_height_map(const std::filesystem::path& path, const HeightPicture& picture) {
  return parse_height_map(read_file(path), path.string(), picture);
}

bool writes_height_map(const std::filesystem::path& path) {
  const std::string end = path.extension().string();
  return end == ".sur" || end == ".x3p" || end == ".exr";
}

void write_height_map(const std::filesystem::path& path, const HeightMap& map) {
  const std::string end = path.extension().string();
  if (end == ".sur") return write_surf(path, map);
  if (end == ".x3p") return write_x3p(path, map);
  if (end == ".exr") return write_height_picture(path, map);
  throw Error(Exit::usage, path.string(), "is no kind of height map that gonio writes", "name it .sur, .x3p or .exr");
}

}  // namespace gonio::io
