// See tables_text.h.
#include "goniometry/tables/tables_text.h"

#include <algorithm>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "io/csv.h"

namespace gonio::goniometry {
namespace {

constexpr const char* white_space = " \t\r\v\f";

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with('%') || line.starts_with('!') || line.starts_with("//");
}

bool is_number(const std::string& word) {
  try {
    io::csv_number(word, "");
    return true;
  } catch (const Error&) {
    return word == "nan" || word == "NaN" || word == "NAN";
  }
}

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  std::istringstream stream{std::string(line)};
  for (std::string word; stream >> word;) {
    const bool unit = word.starts_with('[') || word.starts_with('(');
    if (unit && !words.empty())
      words.back() += " " + word;
    else
      words.push_back(word);
  }
  return words;
}

std::vector<std::string> split(std::string_view line, char separator) {
  if (separator == ' ') return words_of(line);
  std::vector<std::string> fields;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(separator, at), line.size());
    std::string_view field = line.substr(at, end - at);
    const auto first = field.find_first_not_of(" \t\"");
    field = first == std::string_view::npos ? "" : field.substr(first, field.find_last_not_of(" \t\"") - first + 1);
    fields.emplace_back(field);
    at = end + 1;
  }
  return fields;
}

char separator_of(std::string_view line) {
  for (const char c : {',', ';', '\t'})
    if (line.find(c) != std::string_view::npos) return c;
  return ' ';
}

struct Line {
  std::size_t number = 0;
  std::string text;
};

// Lines that are not empty, comments among them.
std::vector<Line> lines_of(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  std::vector<Line> lines;
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string line(text.substr(at, end - at));
    line.resize(line.find_last_not_of(white_space) + 1);
    ++number;
    at = end + 1;
    if (line.empty()) continue;
    lines.push_back({number, line.substr(line.find_first_not_of(white_space))});
  }
  return lines;
}

void check_names(const TextTable& table) {
  for (std::size_t i = 0; i < table.heading.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (!table.heading[i].empty() && table.heading[i] == table.heading[k])
        throw Error(Exit::data, table.heading_place(), "names column \"" + table.heading[i] + "\" twice",
                    "rename one of the two");
}

void add_row(TextTable& table, const Line& line, std::vector<std::string> fields) {
  if (fields.size() != table.heading.size())
    throw Error(Exit::data, table.name + ":" + std::to_string(line.number),
                "has " + std::to_string(fields.size()) + " fields, the lines before it have " +
                    std::to_string(table.heading.size()),
                "give every row one field for each column");
  table.rows.push_back(std::move(fields));
  table.line.push_back(line.number);
}

// Keywords, then VARS.
TextTable parse_astm(const std::vector<Line>& lines, std::size_t vars, const std::string& name) {
  TextTable table{name, {}, lines[vars].number, {}, {}};
  std::optional<double> announced;
  for (std::size_t i = 0; i < vars; ++i)
    if (const auto words = words_of(lines[i].text); words.size() == 2 && words[0] == "NUM_POINTS")
      announced = io::csv_number(words[1], name + ":" + std::to_string(lines[i].number));
  const std::string names = lines[vars].text.substr(4);
  table.heading = split(names, separator_of(names) == ',' ? ',' : ' ');
  check_names(table);
  for (std::size_t i = vars + 1; i < lines.size(); ++i)
    if (!is_comment(lines[i].text)) add_row(table, lines[i], split(lines[i].text, separator_of(lines[i].text)));
  if (announced && *announced != static_cast<double>(table.rows.size()))
    throw Error(Exit::data, name,
                "announces " + std::to_string(static_cast<long>(*announced)) + " points and has " +
                    std::to_string(table.rows.size()) + " rows",
                "copy the whole file, or correct NUM_POINTS");
  return table;
}

// Names from the last comment that has as many words as there are columns.
void name_by_comment(TextTable& table, const std::vector<Line>& lines, std::size_t first) {
  for (std::size_t i = first; i-- > 0;) {
    std::string text = lines[i].text.substr(lines[i].text.find_first_not_of("#%!/ \t") == std::string::npos
                                                ? lines[i].text.size()
                                                : lines[i].text.find_first_not_of("#%!/ \t"));
    std::vector<std::string> words = split(text, separator_of(text));
    if (words.size() != table.heading.size()) continue;
    table.heading = std::move(words);
    table.heading_line = lines[i].number;
    return;
  }
}

}  // namespace

TextTable parse_text_table(std::string_view text, const std::string& name) {
  if (text.find('\0') != std::string_view::npos)
    throw Error(Exit::data, name, "is no text: it holds a zero byte", "tables of MERL are named *.binary");
  const std::vector<Line> lines = lines_of(text);
  std::size_t first = lines.size();
  for (std::size_t i = lines.size(); i-- > 0;) {
    if (lines[i].text.starts_with("VARS ") || lines[i].text.starts_with("VARS\t")) return parse_astm(lines, i, name);
    if (!is_comment(lines[i].text)) first = i;
  }
  if (first == lines.size()) throw Error(Exit::data, name, "is empty: it holds no line of numbers");
  char separator = separator_of(lines[first].text);
  const auto bare = [](const Line& line) {
    return !is_comment(line.text) && line.text.find('\t') == std::string::npos;
  };
  if (separator == '\t' && std::any_of(lines.begin() + static_cast<std::ptrdiff_t>(first), lines.end(), bare))
    separator = ' ';  // tabs among blanks
  std::vector<std::string> fields = split(lines[first].text, separator);
  const bool named = std::ranges::none_of(fields, is_number);
  if (named && separator == ',') {
    io::Csv csv = io::parse_csv(text, name);
    return {name, std::move(csv.header), lines[first].number, std::move(csv.rows), std::move(csv.line)};
  }
  TextTable table{name, {}, 0, {}, {}};
  table.heading.resize(fields.size());
  if (named) {
    table.heading = std::move(fields);
    table.heading_line = lines[first++].number;
  } else {
    name_by_comment(table, lines, first);
  }
  check_names(table);
  if (first == lines.size()) throw Error(Exit::data, name, "has a header and no rows");
  for (std::size_t i = first; i < lines.size(); ++i)
    if (!is_comment(lines[i].text)) add_row(table, lines[i], split(lines[i].text, separator));
  return table;
}

}  // namespace gonio::goniometry
