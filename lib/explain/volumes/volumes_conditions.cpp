// Conditions of readings of a volume. Each holds for the kinds of reading that its physics could touch.
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/random.h"
#include "explain/volumes/volumes_outcome.h"

namespace gonio::explain {
namespace {

using volumes::Observed, volumes::Reading, volumes::Row;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::vector<Condition> volume_conditions(const Observed& o) {
  std::vector<Condition> conditions;
  const auto add = [&](const char* name, const char* unit, const char* curve_unit, auto value) {
    Condition c{name, unit, "tomograph", {}, {}, curve_unit};
    for (const Row& row : o.rows) c.values.push_back(value(row)), c.direction.push_back(weight_of(row));
    conditions.push_back(std::move(c));
  };
  const auto of = [](Reading reading, auto value) {
    return [=](const Row& row) { return row.reading == reading ? value(row) : none; };
  };
  // An edge that is read off a grid errs with its phase within a voxel: places are told to two voxels and directions to
  // a tenth, so that this is no structure of the recording. Drawn by the place alone, from -1 to 1.
  const auto phase = [](const Row& row) {
    const auto bits = static_cast<std::uint64_t>(std::llround(1e9 * (row.at_m.x + 3 * row.at_m.y + 7 * row.at_m.z)));
    return 2 * Random(bits, 3).uniform() - 1;
  };
  add("volume.size", "voxel", "voxel",
      of(Reading::wall, [&](const Row& row) { return dot(row.at_m, row.normal) / o.voxel_m + 2 * phase(row); }));
  add("volume.curvature", "1/voxel", "voxel",
      of(Reading::wall, [&](const Row& row) { return row.curvature * (1 + 0.2 * phase(row)); }));
  add("volume.edge-azimuth", "rad", "voxel",
      of(Reading::wall, [&](const Row& row) { return std::atan2(row.normal.y, row.normal.x) + 0.2 * phase(row); }));
  add("volume.height", "voxel", "voxel",
      of(Reading::wall, [&](const Row& row) { return row.at_m.z / o.voxel_m + 2 * phase(row); }));
  add("volume.edge-width", "voxel", "voxel",
      of(Reading::width, [&](const Row& row) { return std::abs(row.curvature) * (1 + 0.2 * phase(row)); }));
  add("volume.edge-tilt", "1", "voxel",
      of(Reading::width, [&](const Row& row) { return std::abs(row.normal.z) + 0.1 * phase(row); }));
  add("volume.depth", "voxel", "share", of(Reading::inside, [](const Row& row) { return row.depth; }));
  const auto grey = [](auto value) {
    return [=](const Row& row) { return volumes::is_grey(row.reading) ? value(row) : none; };
  };
  add("volume.radius", "radius of the field", "share",
      grey([&](const Row& row) { return std::hypot(row.at_m.x, row.at_m.y) / o.field_m; }));
  add("volume.path", "mm", "share", grey([](const Row& row) { return 1e3 * row.path_m; }));
  if (o.ring_rms > 0) add("volume.ring", "1", "share", grey([](const Row& row) { return row.ring; }));
  bool markers = false;
  for (const Row& row : o.rows) markers = markers || row.marker_path_m > 0;
  if (markers) add("volume.marker-path", "mm", "share", grey([](const Row& row) { return 1e3 * row.marker_path_m; }));
  Condition turned{"volume.azimuth-by-height", "rad", "tomograph", {}, {}, "voxel"};
  for (const Row& row : o.rows) {
    const bool wall = row.reading == Reading::wall;
    turned.values.push_back(wall ? std::atan2(row.normal.y, row.normal.x) + 0.2 * phase(row) : none);
    turned.direction.push_back(wall ? row.at_m.z / o.half_height_m : 0);
  }
  conditions.push_back(std::move(turned));
  return conditions;
}

}  // namespace gonio::explain
