// See model_parameters.h.
#include "explain/tables/model_parameters.h"

#include <cmath>

#include "manifest/sections/table.h"

namespace gonio::explain::tables {

ModelParameter model_parameter(const manifest::Table& section, const std::string& table, const std::string& name,
                               const std::string& unit, double preset, bool free_unless_given) {
  ModelParameter result;
  Parameter& p = result.parameter;
  p.name = "tables/" + table + "/" + name;
  p.unit = unit;
  p.start = preset;
  result.free = free_unless_given;
  if (const auto given = section.parameters.find(name); given != section.parameters.end() && given->second.given()) {
    p.start = given->second.scalar();
    result.free = given->second.free;
    if (given->second.min) p.lower = *given->second.min;
    if (given->second.max) p.upper = *given->second.max;
    p.prior_sigma = given->second.sigma;
  }
  p.neutral = p.start;
  p.size = p.start != 0 ? std::abs(p.start) : 1;
  return result;
}

void store_parameter(manifest::Table& section, const std::string& name, double value, double sigma) {
  manifest::Parameter& p = section.parameters[name];
  p.value = {value};
  if (sigma > 0) {
    p.free = true;
    section.sigmas[name] = {sigma};
  }
}

}  // namespace gonio::explain::tables
