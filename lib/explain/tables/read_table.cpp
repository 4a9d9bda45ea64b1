// See read_table.h: cells from CSV, JSON and inline rows.
#include "explain/tables/read_table.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "explain/tables/unit.h"
#include "goniometry/tables/sample_table.h"
#include "goniometry/tables/tables_text.h"
#include "io/csv.h"
#include "manifest/fields.h"
#include "manifest/sections/table.h"

namespace gonio::explain::tables {
namespace {

using manifest::Value;

constexpr std::uint64_t largest_file = std::uint64_t{1} << 30;

// A source of cells: headings, and the cell of a row as number or as text.
struct Cells {
  std::vector<std::string> headings;
  std::size_t rows = 0;
  std::function<bool(std::size_t row, std::size_t column)> is_text;
  std::function<double(std::size_t row, std::size_t column)> number;  // throws with its place
  std::function<std::string(std::size_t row, std::size_t column)> text;
  std::string place;  // of the headings
};

bool parses(const std::string& text) {
  try {
    io::csv_number(text, "");
    return true;
  } catch (const Error&) {
    return false;
  }
}

Cells cells_of(const goniometry::TextTable& table) {
  for (std::size_t c = 0; c < table.heading.size(); ++c)
    if (table.heading[c].empty())
      throw Error(Exit::data, table.heading_place(), "column " + std::to_string(c + 1) + " has no name",
                  "the first line, or the last comment above the numbers, names every column");
  return {table.heading,
          table.rows.size(),
          [&table](std::size_t r, std::size_t c) { return !parses(table.rows[r][c]); },
          [&table](std::size_t r, std::size_t c) {
            return io::csv_number(table.rows[r][c], table.place(r) + ": " + table.heading[c]);
          },
          [&table](std::size_t r, std::size_t c) { return table.rows[r][c]; },
          table.heading_place()};
}

double json_number(const Value& cell, const std::string& place) {
  if (!cell.is_number()) throw Error(Exit::data, place, "is no number");
  return cell.as_number();
}

std::string json_text(const Value& cell) {
  return cell.is_string() ? cell.as_string() : manifest::print_json(cell, -1);
}

// Rows [[...], ...] in the order of `headings`.
Cells cells_of(const Value& rows, std::vector<std::string> headings, const std::string& place) {
  const Value::Array& all = rows.as_array();
  const auto at = [place](std::size_t r, std::size_t c) {
    return place + "/rows/" + std::to_string(r) + "/" + std::to_string(c);
  };
  return {std::move(headings),
          all.size(),
          [&all](std::size_t r, std::size_t c) { return !all[r].as_array()[c].is_number(); },
          [&all, at](std::size_t r, std::size_t c) { return json_number(all[r].as_array()[c], at(r, c)); },
          [&all](std::size_t r, std::size_t c) { return json_text(all[r].as_array()[c]); },
          place};
}

// {"units": {...}, "rows": [{...}, ...]}, or the list of objects alone; turned into rows in order.
Cells cells_of_objects(const Value& file, const std::string& name, Value& rows) {
  const Value* list = file.is_array() ? &file : file.find("rows");
  if (list == nullptr || !list->is_array() || list->as_array().empty() || !list->as_array()[0].is_object())
    throw Error(Exit::data, name, "is no table", "write {\"units\": {...}, \"rows\": [{\"column\": value, ...}, ...]}");
  std::vector<std::string> columns, headings;
  for (const auto& member : list->as_array()[0].as_object()) columns.push_back(member.first);
  const Value* units = file.find("units");
  for (const std::string& column : columns) {
    const Value* unit = units == nullptr ? nullptr : units->find(column);
    if (unit != nullptr && !unit->is_string())
      throw Error(Exit::data, name + "#/units/" + column, "is no unit in quotes");
    headings.push_back(unit == nullptr || unit->as_string().empty() ? column : column + " [" + unit->as_string() + "]");
  }
  rows = Value::array();
  for (std::size_t r = 0; r < list->as_array().size(); ++r) {
    const Value& row = list->as_array()[r];
    Value cells = Value::array();
    for (const std::string& column : columns) {
      const Value* cell = row.find(column);
      if (cell == nullptr || row.as_object().size() != columns.size())
        throw Error(Exit::data, name + "#/rows/" + std::to_string(r),
                    "has other columns than the first row" + (cell == nullptr ? ": no \"" + column + "\"" : ""));
      cells.push_back(*cell);
    }
    rows.push_back(std::move(cells));
  }
  return cells_of(rows, std::move(headings), name + "#");
}

// What the section says about a column's unit; null where it says nothing.
const std::string* declared_unit(const manifest::Table& section, const std::string& name) {
  for (const auto& [column, unit] : section.columns)
    if (column == name) return &unit;
  return nullptr;
}

struct Found {
  std::size_t place = 0;
  Heading heading;
};
// The file's column that the section calls `name`.
Found column_named(const std::string& name, const Cells& cells, const std::vector<Heading>& headings,
                   const std::string& place) {
  for (std::size_t c = 0; c < headings.size(); ++c)
    if (headings[c].name == name || cells.headings[c] == name) return {c, headings[c]};
  throw Error(Exit::data, cells.place, "has no column \"" + name + "\", which " + place + " names",
              manifest::remedy_for(name, cells.headings));
}

void append(const Cells& cells, const Found& found, const std::string& name, const std::string* declared,
            RawTable& table) {
  Unit unit = found.heading.unit;
  if (declared != nullptr && !declared->empty()) {
    const Unit wanted = parse_unit(*declared, cells.place);
    if (found.heading.has_unit && wanted.powers != unit.powers)
      throw Error(
          Exit::data, cells.place,
          "column " + cells.headings[found.place] + " is in " + unit.text() + ", the manifest says " + *declared,
          "state the same dimension in both");
    if (!found.heading.has_unit) unit = wanted;
  }
  const bool names = declared != nullptr && !found.heading.has_unit ? declared->empty() && cells.is_text(0, found.place)
                                                                    : cells.is_text(0, found.place);
  std::vector<double> values(cells.rows);
  std::vector<std::string> labels;
  for (std::size_t r = 0; r < cells.rows; ++r) {
    if (!names) {
      values[r] = cells.number(r, found.place) * unit.factor;
      continue;
    }
    const std::string label = cells.text(r, found.place);
    const auto known = std::find(labels.begin(), labels.end(), label);
    values[r] = static_cast<double>(known - labels.begin());
    if (known == labels.end()) labels.push_back(label);
  }
  table.columns.push_back(name);
  table.units.push_back(unit);
  table.values.push_back(std::move(values));
  table.labels.push_back(std::move(labels));
}

RawTable raw_of(const Cells& cells, const manifest::Table& section, const std::string& place) {
  std::vector<Heading> headings;
  for (const std::string& heading : cells.headings) headings.push_back(parse_heading(heading, cells.place));
  RawTable table;
  if (section.columns.empty()) {
    for (std::size_t c = 0; c < headings.size(); ++c) append(cells, {c, headings[c]}, headings[c].name, nullptr, table);
    return table;
  }
  for (const auto& [name, unit] : section.columns)
    append(cells, column_named(name, cells, headings, place), name, declared_unit(section, name), table);
  return table;
}

RawTable of_samples(const goniometry::ReadTable& read, const manifest::Table& section, const std::string& place) {
  const manifest::Table all = goniometry::sample_table(read.samples);
  std::vector<std::string> headings;
  for (const auto& [column, unit] : all.columns) headings.push_back(column + " [" + unit + "]");
  return raw_of(cells_of(all.rows, std::move(headings), read.samples.name), section, place);
}

}  // namespace

RawTable read_raw(const std::filesystem::path& path, const manifest::Table& section, const std::string& place) {
  if (goniometry::describes_itself(path)) return of_samples(goniometry::read_table(path), section, place);
  const std::string name = path.filename().string(), text = read_file(path, largest_file);
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && (text[first] == '{' || text[first] == '[')) {
    const Value file = manifest::parse_json(text, name);
    Value rows;
    return raw_of(cells_of_objects(file, name, rows), section, place);
  }
  const goniometry::TextTable table = goniometry::parse_text_table(text, name);
  return raw_of(cells_of(table), section, place);
}

RawTable read_inline(const manifest::Table& section, const std::string& place) {
  if (!section.rows.is_array() || section.rows.as_array().empty())
    throw Error(Exit::data, place, "has neither file nor rows");
  std::vector<std::string> headings;
  for (const auto& column : section.columns) headings.push_back(column.first);
  for (std::size_t r = 0; r < section.rows.as_array().size(); ++r) {
    const Value& row = section.rows.as_array()[r];
    if (!row.is_array() || row.as_array().size() != headings.size())
      throw Error(Exit::data, place + "/rows/" + std::to_string(r), "has not one value per column");
  }
  return raw_of(cells_of(section.rows, headings, place), section, place);
}

}  // namespace gonio::explain::tables
