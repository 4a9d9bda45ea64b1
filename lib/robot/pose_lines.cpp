// See pose_lines.h.
#include "robot/pose_lines.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "base/error.h"

namespace gonio::robot {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}
bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

}  // namespace

// Without comment and brackets; `p[1, 2]` loses its p, too.
std::string bare_line(std::string_view line) {
  for (const std::string_view mark : {"#", "%", "//"}) line = line.substr(0, line.find(mark));
  std::string text;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == 'p' && i + 1 < line.size() && line[i + 1] == '[') continue;
    if (c == '[' || c == ']' || c == '(' || c == ')' || c == '{' || c == '}') continue;
    text += c;
  }
  return text;
}

// Fields between commas, semicolons and blanks. A comma between two digits is a decimal comma where the line has
// another separator that works: `0,5 0,25` and `0,5; 0,25`.
std::vector<std::string> fields_of_line(const std::string& text, const std::string& place) {
  bool inner = false, other = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == ';') other = true;
    if (text[i] == ',')
      inner = inner || (i > 0 && i + 1 < text.size() && is_digit(text[i - 1]) && is_digit(text[i + 1]));
    if (!is_blank(text[i]) || i == 0) continue;
    const auto next = text.find_first_not_of(" \t\r", i);
    other = other || (text[i - 1] != ',' && !is_blank(text[i - 1]) && next != std::string::npos && text[next] != ',' &&
                      (is_digit(text[i - 1]) || text[i - 1] == '.'));
  }
  if (inner && other)
    throw Error(Exit::data, place, "commas inside numbers: decimal commas are not read", "write 0.5 for 0,5");
  std::vector<std::string> fields;
  bool open = false, separated = true;  // separated: a comma or semicolon may not follow another
  for (const char c : text) {
    const bool hard = c == ',' || c == ';';
    if (hard && separated)
      throw Error(Exit::data, place, "an empty field", "every separator stands between two numbers");
    if (hard || is_blank(c)) {
      open = false;
      separated = separated || hard;
      continue;
    }
    if (!open) fields.emplace_back();
    fields.back() += c;
    open = true;
    separated = false;
  }
  return fields;
}

std::optional<double> number_of_field(const std::string& text) {
  const char* begin = text.data() + (text.size() > 1 && text[0] == '+' ? 1 : 0);
  double value = 0;
  const auto end = std::from_chars(begin, text.data() + text.size(), value);
  if (end.ec != std::errc{} || end.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

double finite_number(const std::string& field, const std::string& place) {
  const std::optional<double> value = number_of_field(field);
  if (!value) throw Error(Exit::data, place, "\"" + field + "\" is no number");
  if (!std::isfinite(*value)) throw Error(Exit::data, place, field + " is not a finite number", "drop this pose");
  return *value;
}

std::vector<NumberLine> number_lines(std::string_view text, const std::string& file) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark
  std::vector<NumberLine> lines;
  bool header_seen = false;
  int count = 0;
  while (!text.empty()) {
    const auto end = text.find('\n');
    const std::string line = bare_line(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    NumberLine result{{}, {}, file + ":" + std::to_string(++count)};
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::vector<std::string> fields = fields_of_line(line, result.place);
    std::size_t numbers = 0;
    for (const std::string& f : fields) numbers += number_of_field(f).has_value();
    if (numbers == 0 && lines.empty() && !header_seen) {
      header_seen = true;
      continue;
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (i == 0 && numbers > 0 && !number_of_field(fields[i]))
        result.name = fields[i];
      else
        result.numbers.push_back(finite_number(fields[i], result.place));
    }
    lines.push_back(std::move(result));
  }
  return lines;
}

}  // namespace gonio::robot
