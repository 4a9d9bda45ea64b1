// See height_map.h.
#include "io/height_map.h"

#include "base/atomic_file.h"
#include "io/height_map_checks.h"

namespace gonio::io {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view surf = "DIGITAL SURF", opd =
                                                      "\x01\x00"
                                                      "Directory"sv;

bool is_nms(std::string_view file) {
  return file.size() >= 16 && file.substr(0, 8) == "\x02\x00\x00\x00\x01\x00\x00\x00"sv;
}

}  // namespace

bool is_height_map(std::string_view beginning) {
  return beginning.starts_with(surf) || beginning.starts_with(opd) || is_nms(beginning);
}

HeightMap parse_height_map(std::string_view file, const std::string& place) {
  if (file.starts_with(surf)) return parse_surf(file, place);
  if (file.starts_with(opd)) return parse_opd(file, place);
  if (is_nms(file)) return parse_nms(file, place);
  refuse_map(place, "is no height map that gonio reads: it begins like none of them");
}

HeightMap read_height_map(const std::filesystem::path& path) {
  return parse_height_map(read_file(path), path.string());
}

}  // namespace gonio::io
