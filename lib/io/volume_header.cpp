#include "io/volume_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <map>

#include "io/volume_grid.h"

namespace gonio::io {
namespace {

constexpr std::int64_t most_files = 1 << 20;
constexpr std::size_t longest_shown = 40;

bool is_blank(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

template <class T, class Parse>
std::vector<T> all_of(std::string_view text, std::size_t count, const char* field, const std::string& place,
                      Parse parse) {
  std::vector<T> values;
  for (const std::string& word : words(text)) {
    const auto value = parse(word);
    if (!value) refuse_volume(place, std::string("has \"") + shown(word) + "\" among its " + field);
    values.push_back(*value);
  }
  if (values.size() != count)
    refuse_volume(place, "has " + std::to_string(values.size()) + " " + field + ", and " + std::to_string(count) +
                             " belong there");
  return values;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> out;
  std::string word;
  for (const char c : text) {
    if (!is_blank(c) && c != ',') {
      word += c;
    } else if (!word.empty()) {
      out.push_back(std::move(word));
      word.clear();
    }
  }
  if (!word.empty()) out.push_back(std::move(word));
  return out;
}

std::optional<double> number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc{} || end != word.data() + word.size()) return {};
  return value;
}

std::optional<std::int64_t> integer_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc{} || end != word.data() + word.size()) return {};
  return value;
}

std::vector<double> numbers_of(std::string_view text, std::size_t count, const char* field, const std::string& place) {
  return all_of<double>(text, count, field, place, number_of);
}

std::vector<std::int64_t> integers_of(std::string_view text, std::size_t count, const char* field,
                                      const std::string& place) {
  return all_of<std::int64_t>(text, count, field, place, integer_of);
}

std::string shown(std::string_view text) {
  std::string out(text.substr(0, longest_shown));
  for (char& c : out)
    if (c < ' ' || c > '~') c = '?';
  return text.size() > longest_shown ? out + "..." : out;
}

std::optional<double> metres_of_unit(std::string_view unit) {
  static const std::map<std::string, double, std::less<>> units = {{"m", 1},
                                                                   {"meter", 1},
                                                                   {"meters", 1},
                                                                   {"metre", 1},
                                                                   {"metres", 1},
                                                                   {"cm", 1e-2},
                                                                   {"centimeter", 1e-2},
                                                                   {"centimeters", 1e-2},
                                                                   {"mm", 1e-3},
                                                                   {"millimeter", 1e-3},
                                                                   {"millimeters", 1e-3},
                                                                   {"millimetre", 1e-3},
                                                                   {"millimetres", 1e-3},
                                                                   {"um", 1e-6},
                                                                   {"micron", 1e-6},
                                                                   {"microns", 1e-6},
                                                                   {"micrometer", 1e-6},
                                                                   {"micrometers", 1e-6},
                                                                   {"micrometre", 1e-6},
                                                                   {"micrometres", 1e-6},
                                                                   {"\xc2\xb5m", 1e-6},
                                                                   {"\xce\xbcm", 1e-6},
                                                                   {"\xb5m", 1e-6},
                                                                   {"nm", 1e-9},
                                                                   {"nanometer", 1e-9},
                                                                   {"nanometers", 1e-9},
                                                                   {"nanometre", 1e-9},
                                                                   {"in", 0.0254},
                                                                   {"inch", 0.0254},
                                                                   {"inches", 0.0254}};
  const auto found = units.find(lower(trimmed(unit)));
  if (found == units.end()) return {};
  return found->second;
}

std::filesystem::path beside(const std::filesystem::path& head, std::string_view name) {
  const std::string text(trimmed(name));
  const std::filesystem::path file = std::filesystem::path(text).lexically_normal();
  if (text.empty() || text.find('\0') != std::string::npos)
    refuse_volume(head.string(), "names no file for its samples");
  if (file.is_absolute() || *file.begin() == "..")
    refuse_volume(head.string(), "asks for samples outside its folder, in \"" + shown(text) + "\"",
                  "put that file beside the head and name it without a folder");
  return head.parent_path() / file;
}

std::vector<std::string> names_of_pattern(std::string_view pattern, std::int64_t first, std::int64_t last,
                                          std::int64_t step, const std::string& place) {
  const auto refuse = [&](const char* why) {
    refuse_volume(place, "names its data files \"" + shown(pattern) + "\", " + why);
  };
  const auto percent = pattern.find('%');
  std::size_t at = percent + 1, width = 0;
  if (percent == std::string_view::npos) refuse("which has no %d for their numbers");
  const bool zeros = at < pattern.size() && pattern[at] == '0';
  while (at < pattern.size() && pattern[at] >= '0' && pattern[at] <= '9' && width < 100)
    width = 10 * width + static_cast<std::size_t>(pattern[at++] - '0');
  if (width > 20 || at >= pattern.size() || (pattern[at] != 'd' && pattern[at] != 'i' && pattern[at] != 'u') ||
      pattern.find('%', at) != std::string_view::npos)
    refuse("and one %d or %03d is possible there");
  if (step == 0 || first < 0 || last < 0 || first > std::int64_t{1} << 40 || last > std::int64_t{1} << 40 ||
      std::abs(step) > std::int64_t{1} << 40 || (step > 0) != (first <= last))
    if (first != last || step == 0) refuse("and no row of numbers for it");
  if (std::abs(last - first) / std::abs(step) >= most_files) refuse("for more than 1048576 files");
  std::vector<std::string> names;
  for (std::int64_t n = first; step > 0 ? n <= last : n >= last; n += step) {
    std::string digits = std::to_string(n);
    if (digits.size() < width) digits.insert(0, width - digits.size(), zeros ? '0' : ' ');
    names.push_back(std::string(pattern.substr(0, percent)) + digits + std::string(pattern.substr(at + 1)));
  }
  return names;
}

}  // namespace gonio::io
