// The manifest's "tables" as samples, in the form that explain(1) takes them, too.
#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "goniometry/tables/sample_table.h"
#include "goniometry/tables/tables_readings.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::goniometry {
namespace {

constexpr std::uint64_t largest_file = std::uint64_t{1} << 30;

// Rows inline, printed as the text that a file would hold.
TextTable inline_table(const manifest::Table& section, const std::string& place) {
  TextTable table{place, {}, 0, {}, {}};
  for (const auto& column : section.columns) table.heading.push_back(column.first);
  for (std::size_t r = 0; r < section.rows.as_array().size(); ++r) {
    std::vector<std::string> fields;
    for (const manifest::Value& cell : section.rows.as_array()[r].as_array())
      fields.push_back(cell.is_string() ? cell.as_string() : manifest::print_json(cell, -1));
    table.rows.push_back(std::move(fields));
    table.line.push_back(r + 1);
  }
  return table;
}

// What the section says about its columns, as the user would with --columns.
std::vector<ColumnUse> uses_of(const manifest::Table& section) {
  std::vector<ColumnUse> uses;
  const auto is_one_of = [](const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
  };
  for (const auto& [name, unit] : section.columns) {
    std::string stem = name;
    for (const char* end : {"_rad", "_m"})
      if (stem.ends_with(end)) stem.resize(stem.size() - std::string(end).size());
    if (is_one_of(section.observed, name))
      uses.push_back({"f", name, unit, true});
    else if (is_one_of(section.sigma, name))
      uses.push_back({"sigma", name, unit, true});
    else if (name == section.group)
      uses.push_back({"series", name, "", true});
    else if (stem == "theta_i" || stem == "phi_i" || stem == "theta_o" || stem == "phi_o" || stem == "wavelength" ||
             stem == "channel")
      uses.push_back({stem, name, unit, true});
  }
  return uses;
}

}  // namespace

ReadTable read_table(const manifest::Document& document, const std::string& name, const TableOptions& options) {
  const auto found = document.tables.find(name);
  if (found == document.tables.end())
    throw Error(Exit::data, manifest::place(document, "/tables"), "has no table \"" + name + "\"");
  const manifest::Table& section = found->second;
  const std::string place = manifest::place(document, "/tables/" + name);
  TableOptions stated = options;
  if (stated.columns.empty()) stated.columns = uses_of(section);
  Readings readings;
  if (section.file.empty()) {
    if (section.rows.is_null()) throw Error(Exit::data, place, "has neither file nor rows");
    readings = column_readings(inline_table(section, place + "/rows"), stated);
  } else {
    const std::filesystem::path path = manifest::resolve(document, section.file, "/tables/" + name + "/file");
    if (section.columns.empty() || describes_itself(path)) {
      ReadTable table = read_table(path, options);
      table.samples.name = name;
      return table;
    }
    readings = column_readings(parse_text_table(read_file(path, largest_file), path.filename().string()), stated);
  }
  readings.preset = Mirror::opposite;  // gonio-conventions(7)
  ReadTable table = samples_of(std::move(readings), options);
  table.samples.name = name;
  return table;
}

}  // namespace gonio::goniometry
