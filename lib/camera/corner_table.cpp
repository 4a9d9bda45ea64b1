// Rows of corners to and from JSON and CSV (RFC 4180 for the image ids; numbers in the shortest form that reads back
// the same).
#include "camera/corner_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::camera {
namespace {

enum Column : std::size_t {
  image,
  corner,
  board_x,
  board_y,
  u,
  v,
  sigma,
  weight,  // from here on they may be left out
  channel,
  turned,
  time,
  temperature,
  columns
};
constexpr std::size_t written = channel;  // what calib-charuco finds
constexpr std::array<std::pair<const char*, const char*>, columns> names = {{{"image", ""},
                                                                             {"corner", "1"},
                                                                             {"board_x_m", "m"},
                                                                             {"board_y_m", "m"},
                                                                             {"u_px", "px"},
                                                                             {"v_px", "px"},
                                                                             {"sigma_px", "px"},
                                                                             {"weight", "1"},
                                                                             {"channel", "1"},
                                                                             {"turned_rad", "rad"},
                                                                             {"time_s", "s"},
                                                                             {"temperature_K", "K"}}};
constexpr std::array<double, columns> presets = {0, 0, 0, 0, 0, 0, 0, 1, 1, 0, not_stated, not_stated};
constexpr std::size_t nowhere = static_cast<std::size_t>(-1);
constexpr double largest_corner_id = 1e6;

// Where each of our columns stands in the rows.
std::array<std::size_t, columns> places_of(const std::vector<std::string>& given, const std::string& place) {
  std::array<std::size_t, columns> places{};
  for (std::size_t i = 0; i < columns; ++i) {
    const auto found = std::ranges::find(given, names[i].first);
    if (found == given.end() && i >= weight) {
      places[i] = nowhere;
      continue;
    }
    if (found == given.end()) {
      throw Error(Exit::data, place, std::string("column ") + names[i].first + " is missing",
                  "a table of corners has image, corner, board_x_m, board_y_m, u_px, v_px, sigma_px");
    }
    places[i] = static_cast<std::size_t>(found - given.begin());
  }
  return places;
}

void append(CornerTable& table, const std::string& name, const std::array<double, columns>& value,
            const std::string& place) {
  for (std::size_t i = corner; i < columns; ++i) {
    if (!std::isfinite(value[i]) && !std::isnan(presets[i]))
      throw Error(Exit::data, place, std::string(names[i].first) + " is not a finite number");
  }
  if (!(value[sigma] > 0))
    throw Error(Exit::data, place, "sigma_px is not above 0", "state the noise of the corner in pixels");
  if (!(value[weight] >= 0)) throw Error(Exit::data, place, "weight is below 0");
  if (value[channel] != 0 && value[channel] != 1 && value[channel] != 2)
    throw Error(Exit::data, place, "channel is none of 0, 1, 2", "0 red, 1 green, 2 blue");
  if (!(std::abs(value[corner]) <= largest_corner_id)) throw Error(Exit::data, place, "corner is no corner's number");
  auto group = std::find_if(table.images.rbegin(), table.images.rend(),
                            [&](const ImageCorners& candidate) { return candidate.image == name; });
  if (group == table.images.rend()) {
    table.images.push_back({name, {}});
    group = table.images.rbegin();
  }
  group->corners.push_back({static_cast<int>(value[corner]),
                            {value[board_x], value[board_y]},
                            {value[u], value[v]},
                            value[sigma],
                            value[weight],
                            static_cast<int>(value[channel]),
                            value[turned],
                            value[time],
                            value[temperature]});
}

// One record of a CSV file, from `at` to behind its line end. Fields may be quoted, with "" for a quote.
std::vector<std::string> record(std::string_view text, std::size_t& at) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quoted) {
      if (c != '"') {
        fields.back() += c;
      } else if (at + 1 < text.size() && text[at + 1] == '"') {
        fields.back() += '"';
        ++at;
      } else {
        quoted = false;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',') {
      fields.emplace_back();
    } else if (c == '\n') {
      ++at;
      break;
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

double number(const std::string& text, const std::string& place) {
  double value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc{} || end.ptr != text.data() + text.size()) {
    throw Error(Exit::data, place, "\"" + text + "\" is no number");
  }
  return value;
}

void read_csv(const std::filesystem::path& path, CornerTable& table) {
  const std::string text = read_file(path);
  std::size_t at = 0;
  const std::vector<std::string> header = record(text, at);
  const auto places = places_of(header, path.filename().string() + ":1");
  for (int line = 2; at < text.size(); ++line) {
    const std::string place = path.filename().string() + ":" + std::to_string(line);
    const std::vector<std::string> fields = record(text, at);
    if (fields.size() == 1 && fields[0].empty()) continue;
    if (fields.size() != header.size()) {
      throw Error(Exit::data, place,
                  std::to_string(fields.size()) + " fields (the header names " + std::to_string(header.size()) + ")");
    }
    std::array<double, columns> value = presets;
    for (std::size_t i = corner; i < columns; ++i) {
      if (places[i] != nowhere) value[i] = number(fields[places[i]], place);
    }
    append(table, fields[places[image]], value, place);
  }
}

void read_rows(const manifest::Table& section, const std::string& place, CornerTable& table) {
  std::vector<std::string> given;
  for (const auto& column : section.columns) given.push_back(column.first);
  const auto places = places_of(given, place + "/columns");
  if (!section.rows.is_array()) throw Error(Exit::data, place + "/rows", "missing", "give a file or rows");
  std::size_t index = 0;
  for (const manifest::Value& row : section.rows.as_array()) {
    const std::string here = place + "/rows/" + std::to_string(index++);
    if (!row.is_array() || row.as_array().size() != given.size()) {
      throw Error(Exit::data, here, "not one value per column (" + std::to_string(given.size()) + ")");
    }
    const auto& cells = row.as_array();
    if (!cells[places[image]].is_string()) throw Error(Exit::data, here, "image is not an id in quotes");
    std::array<double, columns> value = presets;
    for (std::size_t i = corner; i < columns; ++i) {
      if (places[i] == nowhere) continue;
      if (!cells[places[i]].is_number()) throw Error(Exit::data, here, std::string(names[i].first) + " is no number");
      value[i] = cells[places[i]].as_number();
    }
    append(table, cells[places[image]].as_string(), value, here);
  }
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

std::string csv_of(const CornerTable& table) {
  std::string text;
  for (std::size_t i = 0; i < written; ++i) text += std::string(i > 0 ? "," : "") + names[i].first;
  text += '\n';
  for (const ImageCorners& group : table.images) {
    for (const TableCorner& c : group.corners) {
      text += quoted(group.image) + ',' + std::to_string(c.id);
      for (const double x : {c.board_m.x, c.board_m.y, c.pixel.x, c.pixel.y, c.sigma_px, c.weight})
        text += ',' + shortest(x);
      text += '\n';
    }
  }
  return text;
}

manifest::Value rows_of(const CornerTable& table) {
  manifest::Value rows = manifest::Value::array();
  for (const ImageCorners& group : table.images) {
    for (const TableCorner& c : group.corners) {
      rows.push_back(manifest::Value::Array{group.image, c.id, c.board_m.x, c.board_m.y, c.pixel.x, c.pixel.y,
                                            c.sigma_px, c.weight});
    }
  }
  return rows;
}

}  // namespace

CornerTable read_corners(const manifest::Document& document, const std::string& name) {
  const std::string pointer = "/tables/" + name;
  const auto found = document.tables.find(name);
  if (found == document.tables.end()) {
    throw Error(Exit::data, manifest::place(document, pointer), "missing", "calib-charuco writes it");
  }
  CornerTable table{found->second.camera, found->second.board, {}};
  if (!found->second.file.empty()) {
    read_csv(manifest::resolve(document, found->second.file, pointer + "/file"), table);
  } else {
    read_rows(found->second, manifest::place(document, pointer), table);
  }
  return table;
}

void write_corners(const CornerTable& table, const std::string& name, const std::filesystem::path& csv,
                   manifest::Document& document) {
  manifest::Table section;
  section.model = "camera";
  section.camera = table.camera;
  section.board = table.board;
  for (std::size_t i = 0; i < written; ++i) section.columns.emplace_back(names[i].first, names[i].second);
  section.observed = {"u_px", "v_px"};
  section.sigma = {"sigma_px"};
  if (csv.empty()) {
    section.rows = rows_of(table);
  } else {
    write_file(csv, csv_of(table));
    section.file = manifest::add_file(document, csv, name);
  }
  document.tables[name] = section;
}

}  // namespace gonio::camera
