// See placement.h.
#include "explain/tables/placement.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "base/text.h"
#include "camera/quality/alignment.h"
#include "explain/tables/unit.h"

namespace gonio::explain::tables {

Vec3 Placement::seen(std::span<const double> values, Vec3 in_base_m) const {
  const double* moved = &values[first];
  const Quaternion turn = quaternion_of_rotation_vector({moved[0], moved[1], moved[2]});
  return matrix_of(turn) * (start * in_base_m - middle_m) + middle_m + Vec3{moved[3], moved[4], moved[5]};
}

void start_from(Placement& placement, const std::vector<Vec3>& in_base_m, const std::vector<Vec3>& seen_m) {
  const auto motion = camera::aligned(in_base_m, seen_m);
  placement.start = {motion.rotation, motion.translation_m};
  placement.middle_m = std::accumulate(seen_m.begin(), seen_m.end(), Vec3{}) / static_cast<double>(seen_m.size());
}

void declare_placement(Placement& placement, const std::string& prefix, const std::vector<std::size_t>& groups,
                       std::vector<Parameter>& parameters, std::vector<std::size_t>& base) {
  placement.first = parameters.size();
  for (const char* number : {"turn_x_rad", "turn_y_rad", "turn_z_rad", "shift_x_m", "shift_y_m", "shift_z_m"}) {
    Parameter p;
    p.name = prefix + number;
    p.unit = std::string(number).ends_with("_m") ? "m" : "rad";
    p.size = 1e-3;
    p.groups = groups;
    base.push_back(parameters.size());
    parameters.push_back(std::move(p));
  }
}

void check_places_observed(const Table& table, const std::string& model) {
  std::string stems;
  for (const std::size_t c : table.observed) stems += stem_of(table.columns[c]);
  if (stems == "xyz" && std::ranges::all_of(table.observed, [&](std::size_t c) { return table.units[c] == "m"; }))
    return;
  throw Error(Exit::data, table.place + "/observed", "does not name a measured place",
              "model " + model + " predicts three columns: --observed x_m --observed y_m --observed z_m");
}

std::vector<Vec3> observed_places(const Table& table) {
  const auto at = [&](std::size_t axis, std::size_t r) { return table.values[table.observed[axis]][r]; };
  std::vector<Vec3> places;
  for (std::size_t r = 0; r < table.rows(); ++r) places.push_back({at(0, r), at(1, r), at(2, r)});
  return places;
}

RowsByName rows_by_name(const Table& table, const std::string& column) {
  RowsByName rows;
  const std::size_t place = table.place_of(column);
  std::vector<double> seen;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const double value = place == Table::none ? 1 : table.values[place][r];
    const auto at = static_cast<std::size_t>(std::ranges::find(seen, value) - seen.begin());
    rows.of_row.push_back(at);
    if (at < seen.size()) continue;
    seen.push_back(value);
    const bool named = place != Table::none && !table.labels[place].empty();
    rows.names.push_back(named ? table.labels[place][static_cast<std::size_t>(value)] : format("%g", value));
  }
  return rows;
}

}  // namespace gonio::explain::tables
