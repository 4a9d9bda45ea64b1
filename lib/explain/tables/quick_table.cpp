// See quick_table.h.
#include "explain/tables/quick_table.h"

#include <algorithm>
#include <cctype>
#include <fstream>

#include "base/assignment.h"
#include "base/error.h"
#include "base/quantity.h"
#include "base/text.h"
#include "explain/tables/read_table.h"
#include "explain/tables/table_model.h"
#include "io/height_map.h"
#include "manifest/document.h"
#include "manifest/fields.h"
#include "manifest/sections/relief.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/table.h"
#include "relief/document.h"

namespace gonio::explain::tables {
namespace {

constexpr char place_of_units[] = "--units";

std::size_t column_of(const RawTable& raw, const std::string& name, const std::string& place) {
  for (std::size_t c = 0; c < raw.columns.size(); ++c)
    if (raw.columns[c] == name) return c;
  for (std::size_t c = 0; c < raw.columns.size(); ++c)
    if (stem_of(raw.columns[c]) == stem_of(name)) return c;
  throw Error(Exit::usage, place, "the table has no column \"" + name + "\"", manifest::remedy_for(name, raw.columns));
}

// Gives columns the units that the user states; true where values had to be converted.
bool set_units(const std::vector<std::pair<std::string, std::string>>& units, RawTable& raw) {
  bool converted = false;
  for (const auto& [name, text] : units) {
    const std::size_t c = column_of(raw, name, place_of_units);
    Unit unit;
    try {
      unit = parse_unit(text, place_of_units);
    } catch (const Error& e) {
      throw Error(Exit::usage, e.place(), e.problem(), e.remedy());
    }
    if (!raw.units[c].powers.empty() || raw.units[c].factor != 1)
      throw Error(Exit::usage, place_of_units, "column \"" + raw.columns[c] + "\" states its unit itself",
                  "leave it out of --units");
    for (double& v : raw.values[c]) v *= unit.factor;
    converted = converted || unit.factor != 1;
    raw.units[c] = unit;
  }
  return converted;
}

manifest::Value rows_of(const RawTable& raw) {
  manifest::Value rows = manifest::Value::array();
  for (std::size_t r = 0; r < raw.values[0].size(); ++r) {
    manifest::Value row = manifest::Value::array();
    for (std::size_t c = 0; c < raw.columns.size(); ++c) {
      const double v = raw.values[c][r];
      row.push_back(raw.labels[c].empty() ? manifest::Value(v)
                                          : manifest::Value(raw.labels[c][static_cast<std::size_t>(v)]));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> parse_pairs(const std::string& text, const std::string& place) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const std::string& item : pieces(text, ','))
    pairs.push_back(parse_assignment(item, place, "separate several by commas"));
  return pairs;
}

std::vector<std::pair<std::string, double>> parse_numbers(const std::string& text, const std::string& place) {
  std::vector<std::pair<std::string, double>> numbers;
  for (const auto& [name, value] : parse_pairs(text, place))
    numbers.emplace_back(name, parse_quantity(value, Dimension::none, place));
  return numbers;
}

HeightMapKind height_map_kind(const std::filesystem::path& file) {
  std::string beginning(io::height_map_beginning, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  beginning.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, stream.gcount())));
  return io::is_height_map(beginning)       ? HeightMapKind::own
         : io::is_height_picture(beginning) ? HeightMapKind::picture
                                            : HeightMapKind::none;
}

manifest::Document height_map_document(const std::filesystem::path& file, const io::HeightPicture& picture) {
  manifest::Document document;
  document.name = file.string();
  document.allow_outside = true;
  const std::string name = file_stem(file.stem().string());
  manifest::Table section;
  section.model = "heights";
  if (height_map_kind(file) == HeightMapKind::picture)
    section.file =
        document.reliefs.at(relief::enter_map(document, file, io::read_height_map(file, picture), picture)).file;
  else
    section.file = manifest::add_file(document, file, name);
  document.tables[name] = std::move(section);
  return document;
}

// A name alone that is neither a model's nor a column's is more likely a model misspelt than a model of one constant.
void check_model(const QuickTable& quick, const RawTable& raw) {
  const auto is_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_'; };
  const auto known = [&](const std::string& column) { return stem_of(column) == stem_of(quick.model); };
  const auto free = [&](const auto& parameter) { return parameter.first == quick.model; };
  const bool number = !quick.model.empty() && std::isdigit(static_cast<unsigned char>(quick.model[0]));
  if (number || find_model(quick.model) != nullptr || !std::all_of(quick.model.begin(), quick.model.end(), is_name) ||
      std::any_of(raw.columns.begin(), raw.columns.end(), known) ||
      std::any_of(quick.free.begin(), quick.free.end(), free))
    return;
  std::vector<std::string> models;
  for (const Model* model : all_models()) models.push_back(model->name);
  throw Error(Exit::usage, "--model", "\"" + quick.model + "\" is no model, no column and no free parameter",
              manifest::remedy_for(quick.model, models));
}

manifest::Document quick_document(const QuickTable& quick) {
  manifest::Document document;
  document.name = quick.file.string();
  document.allow_outside = true;  // what the user names may lie anywhere
  manifest::Table section;
  section.model = find_model(quick.model) != nullptr ? quick.model : "expression";
  if (section.model == "expression") section.expression = quick.model;
  RawTable raw = read_raw(quick.file, section, quick.file.filename().string());
  check_model(quick, raw);
  const bool converted = set_units(quick.units, raw);
  for (const std::string& name : quick.observed)
    section.observed.push_back(raw.columns[column_of(raw, name, "--observed")]);
  for (const std::string& name : quick.sigma) section.sigma.push_back(raw.columns[column_of(raw, name, "--sigma")]);
  if (!quick.group.empty()) section.group = raw.columns[column_of(raw, quick.group, "--group")];
  if (!quick.block.empty()) section.block = raw.columns[column_of(raw, quick.block, "--block")];
  for (std::size_t c = 0; c < raw.columns.size(); ++c)
    section.columns.emplace_back(raw.columns[c], raw.labels[c].empty() ? raw.units[c].text() : "");
  for (const auto& [name, start] : quick.free) {
    manifest::Parameter p(start);
    p.free = true;
    section.parameters[name] = p;
  }
  if (section.model == "surface") {  // Lambert's law, its colour free
    section.surface = "sample";
    manifest::Surface& sample = document.surfaces[section.surface];
    sample.model = "diffuse";
    sample.parameters["albedo"] = manifest::Parameter(0.5);
    sample.parameters["albedo"].free = true;
  }
  const std::string name = file_stem(quick.file.stem().string());
  if (converted)
    section.rows = rows_of(raw);
  else
    section.file = manifest::add_file(document, quick.file, name);
  document.tables[name] = std::move(section);
  return document;
}

}  // namespace gonio::explain::tables
