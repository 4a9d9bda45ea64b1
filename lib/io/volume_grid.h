// What the readers of volumes settle in the same way and refuse in the same words: sizes, spacings and axes as files
// state them, and wishes beside them.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "io/volume.h"

namespace gonio::io {

[[noreturn]] void refuse_volume(const std::string& place, const std::string& problem,
                                const std::string& remedy = "copy it again, or export it as NRRD");

// "256 x 256 x 128"
std::string size_text(const std::array<std::size_t, 3>& size);
std::string spacing_text(Vec3 spacing, const char* unit);

// A side as a head states it. Error(data) where it is none: zero, negative, above 2^20.
std::size_t checked_side(std::int64_t side, const std::string& place);
// Bytes of all samples; Error(data) above 2^46, so that nothing computed from them overflows.
std::uint64_t checked_volume_bytes(const VolumeHead& head, const std::string& place);

// The grid in the file's own words.
struct StatedGrid {
  std::optional<Vec3> spacing{};  // as it stands there: may be zero or negative, which is refused
  std::optional<Vec3> origin{};
  std::optional<Mat3> axes{};  // columns of length one
  double unit_m = 0;           // of spacing and origin; 0: neither the file nor its format's standard says it
};
// Columns are steps from a voxel to the next: spacing and axes of the grid.
void set_steps(StatedGrid& grid, const Mat3& steps);

// Sets spacing, origin and axes of `head` from what the file and the wish say. Where the file says no unit, the wish
// does, and must keep the ratios that the file has. Error(data) for spacings that are none, axes that are not
// orthogonal, and wishes that contradict the file.
void settle_grid(const StatedGrid& grid, const VolumeWish& wish, VolumeHead& head, const std::string& place);

// A file that describes itself is asked for nothing: Error(data) where the wish has another size or type, or speaks of
// bytes to skip, of their order or of tiles.
void check_wish_of_described(const VolumeHead& head, const VolumeWish& wish, const std::string& place);

}  // namespace gonio::io
