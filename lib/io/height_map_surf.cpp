// Digital Surf's SURF files, format 1 of the "Surface Data File Format" (Digital Surf, 1991), the head of 512 bytes
// that all versions share: places of its fields below, in bytes. A point is z = number * dz in the unit of z.
#include <limits>

#include "base/atomic_file.h"
#include "io/height_map.h"
#include "io/height_map_checks.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

constexpr std::size_t head = 512;
enum Place : std::size_t {
  object_type = 18,
  special_points = 86,
  point_bits = 98,
  lowest = 100,
  highest = 104,
  columns = 108,
  rows = 112,
  points = 116,
  step_x = 120,
  step_y = 124,
  step_z = 128,
  unit_x = 180,
  unit_y = 196,
  unit_z = 212,
  comment_bytes = 334,
  private_bytes = 336
};

double metres_of(std::string_view file, std::size_t place, const std::string& at) {
  std::string unit(file.substr(place, 16));
  unit = unit.substr(0, unit.find_first_of(std::string_view("\0 ", 2)));
  if (unit == "m") return 1;
  if (unit == "mm") return 1e-3;
  if (unit == "nm") return 1e-9;
  if (unit == "um" || unit == "\xb5m" || unit == "\xc2\xb5m") return 1e-6;
  refuse_map(at, "states lengths in \"" + unit + "\", and m, mm, um and nm are known");
}

}  // namespace

HeightMap parse_surf(std::string_view file, const std::string& place) {
  check_map_bytes(file.size(), head, place);
  const auto type = stored_at<std::int16_t>(file, object_type), bits = stored_at<std::int16_t>(file, point_bits);
  if (type != 2) refuse_map(place, "holds an object of type " + std::to_string(type) + ", and surfaces are of type 2");
  if (bits != 16 && bits != 32) refuse_map(place, "has points of " + std::to_string(bits) + " bits, not 16 or 32");
  const auto width = stored_at<std::int32_t>(file, columns), height = stored_at<std::int32_t>(file, rows);
  check_map_size(width, height, place);
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const auto comment = stored_at<std::int16_t>(file, comment_bytes), own = stored_at<std::int16_t>(file, private_bytes);
  if (comment < 0 || own < 0) refuse_map(place, "claims a comment of negative length");
  const std::size_t first = head + static_cast<std::size_t>(comment) + static_cast<std::size_t>(own),
                    bytes = static_cast<std::size_t>(bits) / 8;
  check_map_bytes(file.size(), first + count * bytes, place);

  HeightMap map{static_cast<std::size_t>(width), static_cast<std::size_t>(height), 0, 0, {}};
  map.step_x_m =
      checked_step(static_cast<double>(stored_at<float>(file, step_x)) * metres_of(file, unit_x, place), "x", place);
  map.step_y_m =
      checked_step(static_cast<double>(stored_at<float>(file, step_y)) * metres_of(file, unit_y, place), "y", place);
  const double scale = static_cast<double>(stored_at<float>(file, step_z)) * metres_of(file, unit_z, place);
  if (!(std::isfinite(scale) && scale != 0)) refuse_map(place, "states no step of height");
  const bool special = stored_at<std::int16_t>(file, special_points) != 0;
  const std::int64_t missing = std::int64_t{stored_at<std::int32_t>(file, lowest)} - 2;
  map.z_m.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t number = bits == 16 ? std::int64_t{stored_at<std::int16_t>(file, first + 2 * i)}
                                           : std::int64_t{stored_at<std::int32_t>(file, first + 4 * i)};
    map.z_m[i] =
        special && number == missing ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(number) * scale;
  }
  return map;
}

void write_surf(const std::filesystem::path& path, const HeightMap& map) {
  const std::size_t count = map.width * map.height;
  std::string file(head + 4 * count, '\0');
  double reach = 0;
  for (const double z : map.z_m)
    if (std::isfinite(z)) reach = std::max(reach, std::abs(z));
  const double scale = reach > 0 ? reach / 1073741824.0 : 1e-12;
  file.replace(0, 12, "DIGITAL SURF");
  store_at<std::int16_t>(file, 14, 1);
  store_at<std::int16_t>(file, 16, 1);
  store_at<std::int16_t>(file, object_type, 2);
  store_at<std::int16_t>(file, special_points, 1);
  store_at<std::int16_t>(file, point_bits, 32);
  constexpr std::int32_t bottom = -1073741824;
  store_at<std::int32_t>(file, lowest, bottom);
  store_at<std::int32_t>(file, highest, -bottom);
  store_at(file, columns, static_cast<std::int32_t>(map.width));
  store_at(file, rows, static_cast<std::int32_t>(map.height));
  store_at(file, points, static_cast<std::int32_t>(count));
  store_at(file, step_x, static_cast<float>(map.step_x_m));
  store_at(file, step_y, static_cast<float>(map.step_y_m));
  store_at(file, step_z, static_cast<float>(scale));
  for (std::size_t unit = unit_x; unit < unit_x + 9 * 16; unit += 16) file.replace(unit, 16, "m               ");
  for (std::size_t i = 0; i < count; ++i)
    store_at(file, head + 4 * i,
             std::isfinite(map.z_m[i])
                 ? static_cast<std::int32_t>(std::lround(map.z_m[i] / static_cast<double>(static_cast<float>(scale))))
                 : bottom - 2);
  write_file(path, file);
}

}  // namespace gonio::io
