#include "light/number_file.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/error.h"

namespace gonio::light {

std::string text_of(const std::filesystem::path& path, const std::string& place) {
  if (path.empty()) throw Error(Exit::data, place, "light without its file", "name the table as \"file\"");
  std::error_code failure;
  const auto size = std::filesystem::file_size(path, failure);
  std::ifstream in(path, std::ios::binary);
  if (failure || !in) throw Error(Exit::no_input, path.string(), "cannot be read");
  if (size > largest_lamp_file)
    throw Error(Exit::data, path.string(), "has " + std::to_string(size) + " bytes",
                "lamps' tables have at most 16 MiB");
  std::ostringstream text;
  text << in.rdbuf();
  if (in.bad()) throw Error(Exit::io, path.string(), "cannot be read to its end");
  return text.str();
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    std::string_view line = text.substr(0, end);
    const std::size_t skip = end == std::string_view::npos   ? text.size()
                             : text.substr(end, 2) == "\r\n" ? end + 2
                                                             : end + 1;
    text.remove_prefix(skip);
    while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
    while (!line.empty() && (line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
    lines.emplace_back(line);
  }
  return lines;
}

std::optional<double> number_of(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) return {};
  return value;
}

}  // namespace gonio::light
