// Parameters of a forward model as the manifest's tables/T/parameters states them: 0.5, or {"value": 0.5, "free": true,
// "min": 0, "max": 1, "sigma": 0.1}.
#pragma once
#include <optional>
#include <string>

#include "explain/engine.h"

namespace gonio::explain::tables {

struct ModelParameter {
  Parameter parameter;
  bool free = false;
};
// `name` in the section's parameters; where it is not given: `preset`, free or not. Called "tables/T/name".
ModelParameter model_parameter(const manifest::Table& section, const std::string& table, const std::string& name,
                               const std::string& unit, double preset, bool free_unless_given);

// A fitted value and its sigma into the section, its bounds and prior kept.
void store_parameter(manifest::Table& section, const std::string& name, double value, double sigma);

}  // namespace gonio::explain::tables
