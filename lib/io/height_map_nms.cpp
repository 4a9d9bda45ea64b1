// NanoFocus usurf files, version OM_MS_2.0. Places in bytes: lowest and highest height as doubles, um (16), columns and
// rows as 32-bit integers (1368), steps along x and y as doubles, nm (1376), and at 3468 as many 16-bit integers: 0
// where nothing was measured, 1 to 65535 from the lowest to the highest height. A grey picture of a byte per point
// follows.
#include <limits>

#include "io/height_map.h"
#include "io/height_map_checks.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

enum Place : std::size_t { range = 16, size = 1368, steps = 1376, head = 3468 };

}  // namespace

HeightMap parse_nms(std::string_view file, const std::string& place) {
  check_map_bytes(file.size(), head, place);
  if (file.substr(32, 9) != "OM_MS_2.0") refuse_map(place, "is no file of version OM_MS_2.0");
  const auto width = stored_at<std::uint32_t>(file, size), height = stored_at<std::uint32_t>(file, size + 4);
  check_map_size(width, height, place);
  const std::size_t count = std::size_t{width} * height;
  check_map_bytes(file.size(), head + 2 * count, place);
  const auto low = stored_at<double>(file, range), high = stored_at<double>(file, range + 8);
  if (!(std::isfinite(low) && std::isfinite(high) && high > low && high - low < 1e9))
    refuse_map(place, "states no range of heights");
  HeightMap map{width, height, 0, 0, std::vector<double>(count)};
  map.step_x_m = checked_step(stored_at<double>(file, steps) * 1e-9, "x", place);
  map.step_y_m = checked_step(stored_at<double>(file, steps + 8) * 1e-9, "y", place);
  for (std::size_t i = 0; i < count; ++i) {
    const auto code = stored_at<std::uint16_t>(file, head + 2 * i);
    map.z_m[i] =
        code == 0 ? std::numeric_limits<double>::quiet_NaN() : 1e-6 * (low + (code - 1) / 65534.0 * (high - low));
  }
  return map;
}

}  // namespace gonio::io
