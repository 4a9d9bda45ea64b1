// What a table's columns are called as conditions: exposure_s is "image.exposure", distance_m "light.distance"; columns
// that the library does not know keep their own names.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables {

struct ColumnCondition {
  std::string column, condition, unit, stage;
};
std::span<const ColumnCondition> known_conditions();

// The condition that a column carries, one value per row. Nothing where it is missing, constant, or holds names (but
// for lamps and channels).
std::optional<Condition> condition_of(const Table& table, const std::string& column);
// The rest: every condition of the table's columns whose name is not among `known`.
std::vector<Condition> further_conditions(const Table& table, const manifest::Table& section,
                                          const std::vector<Condition>& known, const std::vector<Column>& of_model);

}  // namespace gonio::explain::tables
