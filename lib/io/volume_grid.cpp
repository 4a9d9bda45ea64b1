#include "io/volume_grid.h"

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/text.h"

namespace gonio::io {
namespace {

constexpr std::int64_t longest_side = 1 << 20;
constexpr std::uint64_t most_volume_bytes = std::uint64_t{1} << 46;
constexpr double most_cosine = 1e-4;      // between axes
constexpr double same_within = 1e-3;      // people type 0.488mm for 0.488281
constexpr double largest_spacing_m = 10;  // beyond any scanner, and below what damaged bytes look like

bool same_spacing(double a, double b) {
  return std::abs(a - b) <= same_within * std::max(std::abs(a), std::abs(b));
}

const char* axis_name(int axis) {
  return axis == 0 ? "i" : axis == 1 ? "j" : "k";
}

Vec3 column_of(const Mat3& m, int c) {
  return {m(0, c), m(1, c), m(2, c)};
}

void check_spacing(Vec3 spacing, double unit_m, const std::string& place,
                   const char* remedy = "correct the spacing in its head") {
  for (int a = 0; a < 3; ++a) {
    if (!std::isfinite(spacing[a]) || spacing[a] <= 0)
      refuse_volume(place,
                    "states a spacing of " + shortest_text(spacing[a]) + " along " + axis_name(a) +
                        ", and distances between voxels are positive",
                    remedy);
    if (const double metres = spacing[a] * (unit_m > 0 ? unit_m : 1); unit_m > 0 && !(metres < largest_spacing_m))
      refuse_volume(place, "states a spacing of " + shortest_text(metres) + " m along " + axis_name(a) +
                               ", and below 10 m are possible");
  }
}

void check_axes(const Mat3& axes, const std::string& place) {
  for (int a = 0; a < 3; ++a)
    for (int b = a + 1; b < 3; ++b) {
      const double cosine = dot(column_of(axes, a), column_of(axes, b));
      if (!(std::abs(cosine) <= most_cosine))
        refuse_volume(place,
                      std::string("has axes ") + axis_name(a) + " and " + axis_name(b) + " that are not orthogonal (" +
                          format("%.4g", std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / pi) +
                          " degrees, cosine at most 1e-4)",
                      "resample it on a rectangular grid");
    }
}

// How many metres the file's unit has if the wish is right.
double unit_by_wish(Vec3 stated, Vec3 wished, const std::string& place) {
  const double unit = wished.x / stated.x;
  for (int a = 1; a < 3; ++a)
    if (!same_spacing(wished[a] / stated[a], unit))
      refuse_volume(place,
                    "states spacings of " + spacing_text(stated, "") + ", and --voxel " + spacing_text(wished, "m") +
                        " has other ratios",
                    "give --voxel in these ratios, or correct the file's head");
  return unit;
}

}  // namespace

void refuse_volume(const std::string& place, const std::string& problem, const std::string& remedy) {
  throw Error(Exit::data, place, problem, remedy);
}

std::string size_text(const std::array<std::size_t, 3>& size) {
  return std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]);
}

std::string spacing_text(Vec3 spacing, const char* unit) {
  std::string text = format("%.6g x %.6g x %.6g", spacing.x, spacing.y, spacing.z);
  return *unit == 0 ? text : text + " " + unit;
}

std::size_t checked_side(std::int64_t side, const std::string& place) {
  if (side < 1 || side > longest_side)
    refuse_volume(place, "claims " + std::to_string(side) + " voxels a side, and 1 to 1048576 are possible");
  return static_cast<std::size_t>(side);
}

std::uint64_t checked_volume_bytes(const VolumeHead& head, const std::string& place) {
  // 2^20 a side and 8 bytes a sample: the product of two sides cannot overflow, the third is asked by division.
  std::uint64_t bytes = bytes_of(head.type);
  for (const std::size_t side : head.size) {
    checked_side(static_cast<std::int64_t>(std::min<std::size_t>(side, std::size_t{1} << 62)), place);
    if (bytes > most_volume_bytes / side)
      refuse_volume(place,
                    "claims " + size_text(head.size) + " voxels of " + name_of(head.type) + ", more than 2^46 bytes");
    bytes *= side;
  }
  return bytes;
}

void set_steps(StatedGrid& grid, const Mat3& steps) {
  Mat3 axes;
  std::array<double, 3> lengths{};
  for (int c = 0; c < 3; ++c) {
    const Vec3 step = column_of(steps, c);
    const double length = norm(step);
    lengths[static_cast<std::size_t>(c)] = length;
    for (int r = 0; r < 3; ++r) axes(r, c) = length > 0 ? step[r] / length : 0;
  }
  grid.spacing = Vec3{lengths[0], lengths[1], lengths[2]};
  grid.axes = axes;
}

void settle_grid(const StatedGrid& grid, const VolumeWish& wish, VolumeHead& head, const std::string& place) {
  if (grid.spacing) check_spacing(*grid.spacing, grid.unit_m, place);
  if (wish.spacing_m) check_spacing(*wish.spacing_m, 1, "--voxel", "say it as 120um or 0.1mm,0.1mm,0.3mm");
  if (grid.origin && !is_finite(*grid.origin)) refuse_volume(place, "states an origin that is no place");
  if (grid.axes) {
    check_axes(*grid.axes, place);
    head.axes = grid.axes;
  }
  double unit_m = grid.unit_m;
  if (grid.spacing && unit_m > 0) {
    head.spacing_m = *grid.spacing * unit_m;
    for (int a = 0; wish.spacing_m && a < 3; ++a)
      if (!same_spacing((*wish.spacing_m)[a], (*head.spacing_m)[a]))
        refuse_volume(place,
                      "states a spacing of " + spacing_text(*head.spacing_m * 1e3, "mm") + ", and --voxel says " +
                          spacing_text(*wish.spacing_m * 1e3, "mm"),
                      "leave --voxel out, or correct the file's head");
  } else {
    const bool ones = grid.spacing && *grid.spacing == Vec3{1, 1, 1};
    if (grid.spacing) head.spacing_note = spacing_text(*grid.spacing, "") + " of no unit";
    head.spacing_m = wish.spacing_m;
    if (wish.spacing_m && grid.spacing) {
      // Ones may stand for nothing: with voxels that are no cubes the file's unit stays unknown, and with it the
      // origin.
      const Vec3 w = *wish.spacing_m;
      if (!ones || (same_spacing(w.x, w.y) && same_spacing(w.x, w.z))) unit_m = unit_by_wish(*grid.spacing, w, place);
    }
  }
  if (grid.origin && unit_m > 0) head.origin_m = *grid.origin * unit_m;
}

void check_wish_of_described(const VolumeHead& head, const VolumeWish& wish, const std::string& place) {
  if (wish.size && *wish.size != head.size)
    refuse_volume(place, "has " + size_text(head.size) + " voxels, and --size says " + size_text(*wish.size),
                  "leave --size out");
  if (wish.type && *wish.type != head.type)
    refuse_volume(place, std::string("stores ") + name_of(head.type) + ", and --type says " + name_of(*wish.type),
                  "leave --type out");
  if (wish.skip_bytes != 0 || wish.big_endian)
    refuse_volume(place, "is " + head.format + ", which says itself where its samples begin and how they are stored",
                  "leave out what is said of raw samples");
  if (wish.tiles) refuse_volume(place, "is " + head.format + ", which has no tiles", "leave --tiles out");
}

VolumeGrid grid_of(const VolumeHead& head) {
  return {stated_spacing(head), head.origin_m.value_or(Vec3{}), head.axes.value_or(Mat3{})};
}

Vec3 stated_spacing(const VolumeHead& head) {
  if (head.spacing_m) return *head.spacing_m;
  const std::string place = head.files.empty() ? "volume" : head.files.front().string();
  refuse_volume(place,
                head.spacing_note.empty() ? "does not say how far its voxels lie apart"
                                          : "does not say how far its voxels lie apart, but " + head.spacing_note,
                "say it with --voxel 120um, or --voxel 0.1mm,0.1mm,0.3mm for i, j and k");
}

}  // namespace gonio::io
