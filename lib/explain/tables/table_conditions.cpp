// See table_conditions.h.
#include "explain/tables/table_conditions.h"

#include <algorithm>

#include "explain/tables/unit.h"
#include "manifest/sections/table.h"

namespace gonio::explain::tables {

std::span<const ColumnCondition> known_conditions() {
  static const std::vector<ColumnCondition> known = {{"exposure_s", "image.exposure", "s", "sensor"},
                                                     {"time_s", "image.time", "s", "light"},
                                                     {"temperature_K", "image.temperature", "K", "sensor"},
                                                     {"radiance", "scene.radiance", "", "sensor"},
                                                     {"distance_m", "light.distance", "m", "light"},
                                                     {"path_m", "volume.path-length", "m", "transport"},
                                                     {"wavelength_m", "light.wavelength", "m", "surface"},
                                                     {"image_radius", "camera.image-radius", "half width", "optics"},
                                                     {"theta_i", "surface.incidence-angle", "rad", "surface"},
                                                     {"theta_o", "surface.exitance-angle", "rad", "surface"},
                                                     {"phi_i", "surface.incidence-azimuth", "rad", "surface"},
                                                     {"phi_o", "surface.exitance-azimuth", "rad", "surface"},
                                                     {"row", "camera.image-y", "px", "sensor"},
                                                     {"channel", "image.channel", "1", "sensor"},
                                                     {"lamp", "light.identity", "1", "light"},
                                                     {"polarizer", "polarimeter.polarizer", "rad", "sensor"},
                                                     {"analyser", "polarimeter.analyser", "rad", "sensor"},
                                                     {"retarder", "polarimeter.retarder", "rad", "optics"}};
  return known;
}

namespace {

const ColumnCondition* known_as(const std::string& column) {
  const auto known = known_conditions();
  const auto found = std::find_if(known.begin(), known.end(), [&](const ColumnCondition& k) {
    return k.column == column || stem_of(k.column) == stem_of(column);
  });
  return found == known.end() ? nullptr : &*found;
}

}  // namespace

std::optional<Condition> condition_of(const Table& table, const std::string& column) {
  const std::size_t c = table.place_of(column);
  if (c == Table::none || !table.varies(column)) return {};
  const ColumnCondition* known = known_as(column);
  const bool counted = known != nullptr && (known->column == "lamp" || known->column == "channel");
  if (!table.labels[c].empty() && !counted) return {};
  Condition condition;
  condition.name = known == nullptr ? table.columns[c] : known->condition;
  condition.unit = known != nullptr && !known->unit.empty() ? known->unit : table.units[c];
  condition.stage = known == nullptr ? "" : known->stage;
  condition.values = table.values[c];
  return condition;
}

std::vector<Condition> further_conditions(const Table& table, const manifest::Table& section,
                                          const std::vector<Condition>& known, const std::vector<Column>& of_model) {
  std::vector<Condition> result;
  const auto has = [](const std::vector<std::size_t>& list, std::size_t c) {
    return std::find(list.begin(), list.end(), c) != list.end();
  };
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const std::string& name = table.columns[c];
    if (has(table.observed, c) || has(table.sigma, c) || name == section.block) continue;
    const bool modelled = std::any_of(of_model.begin(), of_model.end(),
                                      [&](const Column& column) { return table.place_of(column.name) == c; });
    if (modelled) continue;
    std::optional<Condition> condition = condition_of(table, name);
    if (!condition || (name == section.group && known_as(name) == nullptr)) continue;  // a mere label of rows
    const auto same = [&](const Condition& other) { return other.name == condition->name; };
    if (std::none_of(known.begin(), known.end(), same)) result.push_back(std::move(*condition));
  }
  return result;
}

}  // namespace gonio::explain::tables
