// See read_table.h: which rows are held out together, and the table in that order.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/error.h"
#include "base/text.h"
#include "explain/tables/read_table.h"
#include "explain/tables/unit.h"
#include "inference/wording.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::explain::tables {
namespace {

struct Grouping {
  std::vector<std::size_t> of_row;  // group of every row
  std::vector<std::string> names;
};

// "40 degrees", "0.02": of a column, to the digits in which groups differ.
std::string number_name(const RawTable& raw, std::size_t column, double value) {
  constexpr int digits = 7;
  return raw.units[column].text() == "rad" ? inference::quantity(value, "rad", digits) : inference::printed(value, digits);
}

std::string value_name(const RawTable& raw, std::size_t column, double value) {
  if (!raw.labels[column].empty()) return raw.labels[column][static_cast<std::size_t>(value)];
  return raw.columns[column] + " " + number_name(raw, column, value);
}

Grouping by_column(const RawTable& raw, std::size_t column) {
  Grouping grouping;
  std::map<double, std::size_t> seen;
  const auto [least, most] = std::minmax_element(raw.values[column].begin(), raw.values[column].end());
  const double grain = 1e-6 * (*most - *least);
  for (const double value : raw.values[column]) {
    const auto [entry, fresh] = seen.try_emplace(grain > 0 ? std::round(value / grain) : 0, seen.size());
    if (fresh) grouping.names.push_back(value_name(raw, column, value));
    grouping.of_row.push_back(entry->second);
  }
  return grouping;
}

// Contiguous stretches of about equal counts; equal values stay together.
Grouping by_stretches(const RawTable& raw, std::size_t column) {
  const std::vector<double>& x = raw.values[column];
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  Grouping grouping{std::vector<std::size_t>(x.size()), {}};
  const std::size_t wanted = std::min(groups_of_a_stretch, std::max<std::size_t>(fewest_groups, x.size() / 4));
  std::size_t k = 0;
  while (k < order.size()) {
    const std::size_t g = grouping.names.size(), start = k;
    const std::size_t until = std::max(start + 1, (g + 1) * order.size() / wanted);
    while (k < order.size() && (k < until || x[order[k]] == x[order[k - 1]])) grouping.of_row[order[k++]] = g;
    const double from = x[order[start]], to = x[order[k - 1]];
    grouping.names.push_back(raw.columns[column] + " " + number_name(raw, column, from) +
                             (to > from ? " to " + number_name(raw, column, to) : ""));
  }
  return grouping;
}

std::size_t column_of(const Table& table, const std::string& name, const std::string& place) {
  const std::size_t c = table.place_of(name);
  if (c == Table::none) throw Error(Exit::data, place, "names column \"" + name + "\", which the table does not have");
  return c;
}

Grouping grouping_of(const RawTable& raw, const Table& table, const manifest::Table& section, const std::string& usual,
                     const std::vector<std::string>& telling) {
  Grouping grouping;
  if (!section.group.empty()) {
    grouping = by_column(raw, column_of(table, section.group, table.place + "/group"));
    if (grouping.names.size() >= fewest_groups) return grouping;
    throw Error(Exit::data, table.place + "/group",
                "column \"" + section.group + "\" has " + std::to_string(grouping.names.size()) +
                    " values, and explain leaves groups out to judge (at least " + std::to_string(fewest_groups) + ")",
                "name another column, or none: the rows are then cut along the telling condition");
  }
  if (const std::size_t column = table.place_of(usual); !usual.empty() && column != Table::none) {
    grouping = by_column(raw, column);
    if (grouping.names.size() >= fewest_groups) return grouping;
  }
  for (const std::string& name : telling) {
    if (!table.varies(name)) continue;
    grouping = by_stretches(raw, table.place_of(name));
    if (grouping.names.size() >= fewest_groups) return grouping;
  }
  std::vector<double> row(table.rows());
  std::iota(row.begin(), row.end(), 1);
  return by_stretches({{"row"}, {{}}, {row}, {{}}}, 0);
}

void check_observed(const Table& table, const manifest::Table& section) {
  if (section.observed.empty())
    throw Error(Exit::data, table.place + "/observed", "names no column", "say which columns were measured");
  if (!section.sigma.empty() && section.sigma.size() != section.observed.size())
    throw Error(Exit::data, table.place + "/sigma",
                "names " + std::to_string(section.sigma.size()) + " columns for " +
                    std::to_string(section.observed.size()) + " observed ones",
                "one for each, in the same order");
  for (const std::size_t c : table.observed)
    if (!table.labels[c].empty())
      throw Error(Exit::data, table.place + "/observed", "column \"" + table.columns[c] + "\" holds no numbers");
  for (const std::size_t c : table.observed)
    if (!table.varies(table.columns[c]) && table.rows() > 1)
      throw Error(Exit::data, table.place + "/observed",
                  "column \"" + table.columns[c] + "\" is " + shortest_text(table.values[c][0]) + " in all " +
                      std::to_string(table.rows()) + " rows: there is nothing in it to explain",
                  "name the column that was measured");
  for (const std::size_t c : table.sigma)
    for (std::size_t r = 0; r < table.rows(); ++r)
      if (!(table.values[c][r] > 0))
        throw Error(
            Exit::data, table.place + "/sigma",
            "\"" + table.columns[c] + "\" is " + shortest_text(table.values[c][r]) + " in row " + std::to_string(r + 1),
            "one standard deviation is above 0");
  if (table.rows() < fewest_rows)
    throw Error(Exit::data, table.place, "has " + std::to_string(table.rows()) + " rows",
                "give at least " + std::to_string(fewest_rows));
}

void sort_rows(const Grouping& grouping, Table& table) {
  std::vector<std::size_t> order(table.rows());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return grouping.of_row[a] < grouping.of_row[b]; });
  for (std::vector<double>& column : table.values) {
    std::vector<double> sorted(column.size());
    for (std::size_t r = 0; r < order.size(); ++r) sorted[r] = column[order[r]];
    column = std::move(sorted);
  }
  table.group = grouping.names;
  table.first.assign(grouping.names.size() + 1, 0);
  for (const std::size_t g : grouping.of_row) ++table.first[g + 1];
  for (std::size_t g = 0; g < grouping.names.size(); ++g) table.first[g + 1] += table.first[g];
}

// Columns of which rows with the same conditions may differ.
bool is_condition(const Table& table, std::size_t column) {
  const auto in = [&](const std::vector<std::size_t>& list) {
    return std::find(list.begin(), list.end(), column) != list.end();
  };
  return !in(table.observed) && !in(table.sigma) && column != table.place_of("time_s") &&
         column != table.place_of("temperature_K");
}

// Numbers names as another table does; names that it lacks come behind.
void use_labels_of(const std::vector<std::string>& known, const std::vector<std::string>& own,
                   std::vector<double>& values) {
  if (own.empty()) return;
  for (double& value : values) {
    const auto place = static_cast<std::size_t>(value);
    const auto found = std::find(known.begin(), known.end(), own[place]);
    value = static_cast<double>(found != known.end() ? static_cast<std::size_t>(found - known.begin())
                                                     : known.size() + place);
  }
}

// Of every observed column the one that is named after it: "f_sigma" of "f", "u_sigma_px" or "u_px_sigma" of "u_px".
// All of them, or none: a table states its noise whole.
std::vector<std::size_t> sigma_by_name(const Table& table) {
  std::vector<std::size_t> found;
  for (const std::size_t c : table.observed) {
    const std::string& own = table.columns[c];
    std::size_t place = table.place_of(own + "_sigma");
    if (place == Table::none) place = table.place_of(stem_of(own) + "_sigma");
    if (place != Table::none && table.labels[place].empty()) found.push_back(place);
  }
  return found.size() == table.observed.size() ? found : std::vector<std::size_t>{};
}

}  // namespace

Table read_table(const manifest::Document& document, const std::string& name, const std::string& usual,
                 const std::vector<std::string>& telling) {
  const manifest::Table& section = document.tables.at(name);
  Table table;
  table.name = name;
  table.place = manifest::place(document, "/tables/" + name);
  const RawTable raw =
      section.file.empty()
          ? read_inline(section, table.place)
          : read_raw(manifest::resolve(document, section.file, "/tables/" + name + "/file"), section, table.place);
  table.columns = raw.columns;
  for (const Unit& unit : raw.units) table.units.push_back(unit.text());
  table.values = raw.values;
  table.labels = raw.labels;
  for (const std::string& column : section.observed)
    table.observed.push_back(column_of(table, column, table.place + "/observed"));
  for (const std::string& column : section.sigma)
    table.sigma.push_back(column_of(table, column, table.place + "/sigma"));
  if (section.sigma.empty()) table.sigma = sigma_by_name(table);
  check_observed(table, section);
  sort_rows(grouping_of(raw, table, section, usual, telling), table);
  if (table.group.size() < fewest_groups)
    throw Error(Exit::data, table.place, "falls into " + std::to_string(table.group.size()) + " groups",
                "explain leaves groups out to judge (at least " + std::to_string(fewest_groups) + ")");
  return table;
}

std::vector<std::vector<double>> read_repeats(const std::vector<std::filesystem::path>& files,
                                              const manifest::Table& section, const Table& table) {
  const auto key_of = [&](const std::vector<std::vector<double>>& values, std::size_t row) {
    std::vector<double> key;
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      if (is_condition(table, c)) key.push_back(values[c][row]);
    return key;
  };
  manifest::Table wanted = section;
  wanted.columns.clear();
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    wanted.columns.emplace_back(table.columns[c], table.labels[c].empty() ? table.units[c] : "");
  std::vector<std::vector<double>> repeats;
  for (const std::filesystem::path& file : files) {
    RawTable raw = read_raw(file, wanted, "--repeat");
    for (std::size_t c = 0; c < table.columns.size(); ++c) use_labels_of(table.labels[c], raw.labels[c], raw.values[c]);
    std::multimap<std::vector<double>, std::size_t> rows;
    for (std::size_t r = 0; r < raw.values[0].size(); ++r) rows.emplace(key_of(raw.values, r), r);
    std::vector<double> values;
    std::size_t matched = 0;
    for (std::size_t r = 0; r < table.rows(); ++r) {
      const auto found = rows.find(key_of(table.values, r));
      for (const std::size_t c : table.observed)
        values.push_back(found == rows.end() ? std::nan("") : raw.values[c][found->second]);
      if (found == rows.end()) continue;
      rows.erase(found);
      ++matched;
    }
    if (matched < fewest_rows)
      throw Error(Exit::data, file.filename().string(),
                  "repeats the conditions of " + std::to_string(matched) + " rows",
                  "a further take has the same conditions in at least " + std::to_string(fewest_rows) + " rows");
    repeats.push_back(std::move(values));
  }
  return repeats;
}

}  // namespace gonio::explain::tables
