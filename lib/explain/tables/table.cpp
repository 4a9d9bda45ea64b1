// See table_model.h: columns by name, registered models, derivatives of models that have none of their own.
#include <algorithm>

#include "base/error.h"
#include "explain/tables/table_model.h"
#include "explain/tables/unit.h"
#include "manifest/fields.h"

namespace gonio::explain::tables {

std::size_t Table::place_of(const std::string& column) const {
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (columns[c] == column) return c;
  std::string wanted;
  const std::string stem = stem_of(column, &wanted);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (stem_of(columns[c]) != stem) continue;
    if (wanted.empty() || parse_unit(wanted, place).powers == parse_unit(units[c], place).powers) return c;
  }
  return none;
}

const std::vector<double>* Table::find(const std::string& column) const {
  const std::size_t c = place_of(column);
  return c == none ? nullptr : &values[c];
}

bool Table::varies(const std::string& column) const {
  const std::vector<double>* found = find(column);
  return found != nullptr && std::any_of(found->begin(), found->end(), [&](double v) { return v != found->front(); });
}

const std::vector<double>& Table::needed(const std::string& column, const std::string& unit) const {
  const std::size_t c = place_of(column);
  if (c == none) {
    const std::string bare = stem_of(column);
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (columns[k] == bare)
        throw Error(
            Exit::data, place, "column \"" + bare + "\" is in " + units[k] + ", needed in " + unit,
            "state its unit in the heading, \"" + bare + " [" + unit + "]\", by --units, or in the manifest's columns");
    throw Error(Exit::data, place, "has no column \"" + column + "\"" + (unit.empty() ? "" : " [" + unit + "]"),
                manifest::remedy_for(column, columns));
  }
  if (!unit.empty() && parse_unit(units[c], place).powers != parse_unit(unit, place).powers)
    throw Error(Exit::data, place, "column \"" + columns[c] + "\" is in " + units[c] + ", needed in " + unit,
                "state its unit in the heading, \"" + columns[c] + " [" + unit +
                    "]\", by --units, or in the manifest's columns");
  return values[c];
}

const Model* find_model(const std::string& name) {
  for (const Model* model : all_models())
    if (model->name == name) return model;
  return nullptr;
}

void BoundModel::jacobian(std::span<const double> values, std::size_t first, std::size_t last,
                          std::span<const std::size_t> columns, std::span<double> derivatives) const {
  if (columns.empty()) return;
  const std::size_t places = derivatives.size() / columns.size();
  std::vector<double> moved(values.begin(), values.end()), above(places), below(places);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Parameter& p = parameters_[columns[k]];
    const double centre = values[columns[k]], step = 1e-4 * p.size;
    const double upper = std::min(centre + step, std::max(p.upper, centre));
    const double lower = std::max(centre - step, std::min(p.lower, centre));
    moved[columns[k]] = upper;
    predict(moved, first, last, above);
    moved[columns[k]] = lower;
    predict(moved, first, last, below);
    moved[columns[k]] = centre;
    const double scale = upper > lower ? 1 / (upper - lower) : 0;
    for (std::size_t i = 0; i < places; ++i) derivatives[k * places + i] = (above[i] - below[i]) * scale;
  }
}

}  // namespace gonio::explain::tables
