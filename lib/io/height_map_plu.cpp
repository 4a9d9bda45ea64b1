// Sensofar's PLu files, versions 2000 to 2013. Places in bytes: a date as text (0, 128 bytes), seconds since 1970
// (128), a comment (132, 256 bytes), steps along x and y as floats, um (404, 408), the kind of measurement (428: 3 is a
// topography), the number of layers and the version (489, 490). At 500 rows and columns as 32-bit integers, then the
// heights as floats, um, row after row; 1000001 where nothing was measured. The lowest and highest height and pictures
// follow. Versions tell themselves by nothing that matters here; the date is all that the files begin with.
#include <array>
#include <limits>

#include "io/height_map.h"
#include "io/height_map_checks.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

constexpr std::size_t step_x_at = 404, step_y_at = 408, kind_at = 428, size_at = 500, heights_at = 508;
constexpr std::uint32_t topography = 3;
constexpr float not_measured = 1000001;
constexpr float most_um = 1e6;
constexpr std::array<std::string_view, 9> kinds = {"an image",
                                                   "a profile",
                                                   "several profiles",
                                                   "a topography",
                                                   "profiles along coordinates",
                                                   "a thickness",
                                                   "measurements of an application of its own",
                                                   "a map over coordinates",
                                                   "thicknesses over coordinates"};

bool is_word_of(std::string_view words, std::string_view three) {
  for (std::size_t at = 0; at < words.size(); at += 3)
    if (words.substr(at, 3) == three) return true;
  return false;
}

}  // namespace

// "Tue Mar  6 15:28:50 2007", as C's ctime() writes it, and a zero byte.
bool is_plu(std::string_view beginning) {
  constexpr std::string_view pattern = "www mmm dd dd:dd:dd dddd";
  if (beginning.size() <= pattern.size() || !is_word_of("MonTueWedThuFriSatSun", beginning.substr(0, 3)) ||
      !is_word_of("JanFebMarAprMayJunJulAugSepOctNovDec", beginning.substr(4, 3)))
    return false;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const char c = beginning[i], p = pattern[i];
    const bool blank_of_day = i == 8 && c == ' ';
    if (p == 'd' ? !(c >= '0' && c <= '9') && !blank_of_day : p != 'w' && p != 'm' && c != p) return false;
  }
  return beginning[pattern.size()] == '\0' || beginning[pattern.size()] == '\n';
}

HeightMap parse_plu(std::string_view file, const std::string& place) {
  check_map_bytes(file.size(), heights_at, place);
  const auto kind = stored_at<std::uint32_t>(file, kind_at);
  if (kind != topography)
    refuse_map(place, "holds " + (kind < kinds.size() ? std::string(kinds[kind]) : "kind " + std::to_string(kind)) +
                          ", and heights are in topographies");
  const auto height = stored_at<std::uint32_t>(file, size_at), width = stored_at<std::uint32_t>(file, size_at + 4);
  check_map_size(width, height, place);
  const std::size_t count = std::size_t{width} * height;
  check_map_bytes(file.size(), heights_at + 4 * count, place);
  const auto step = [&](std::size_t at, const char* axis) {
    return checked_step(std::abs(static_cast<double>(stored_at<float>(file, at))) * 1e-6, axis, place);
  };
  HeightMap map{width, height, step(step_x_at, "x"), step(step_y_at, "y"), std::vector<double>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const auto um = stored_at<float>(file, heights_at + 4 * i);
    const bool measured = um != not_measured && std::abs(um) < most_um;
    map.z_m[i] = measured ? 1e-6 * static_cast<double>(um) : std::numeric_limits<double>::quiet_NaN();
  }
  return map;
}

}  // namespace gonio::io
