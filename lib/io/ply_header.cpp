// The header: lines of words up to `end_header`. An element's count is believed only if its smallest encoding fits into
// what is left of the file.
#include "io/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "base/error.h"

namespace gonio::io {
namespace {

struct ScalarName {
  std::string_view name, other;
  PlyScalar type;
  std::size_t bytes;
};
constexpr std::array scalars = {
    ScalarName{"char", "int8", PlyScalar::int8, 1},        ScalarName{"uchar", "uint8", PlyScalar::uint8, 1},
    ScalarName{"short", "int16", PlyScalar::int16, 2},     ScalarName{"ushort", "uint16", PlyScalar::uint16, 2},
    ScalarName{"int", "int32", PlyScalar::int32, 4},       ScalarName{"uint", "uint32", PlyScalar::uint32, 4},
    ScalarName{"float", "float32", PlyScalar::float32, 4}, ScalarName{"double", "float64", PlyScalar::float64, 8},
};

[[noreturn]] void refuse(const std::string& place, const std::string& problem) {
  throw Error(Exit::data, place, problem, "export or copy it again");
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return words;
    line.remove_prefix(first);
    const auto length = std::min(line.find_first_of(" \t\r"), line.size());
    words.push_back(line.substr(0, length));
    line.remove_prefix(length);
  }
}

PlyScalar scalar(std::string_view word, const std::string& place) {
  for (const auto& s : scalars)
    if (word == s.name || word == s.other) return s.type;
  refuse(place, "the PLY header has a property of unknown type '" + std::string(word) + "'");
}

PlyFormat format(std::string_view word, const std::string& place) {
  if (word == "ascii") return PlyFormat::ascii;
  if (word == "binary_little_endian") return PlyFormat::little_endian;
  if (word == "binary_big_endian") return PlyFormat::big_endian;
  refuse(place, "the PLY header has the unknown format '" + std::string(word) + "'");
}

PlyElement element(const std::vector<std::string_view>& words, const std::string& place) {
  PlyElement result{std::string(words[1]), 0, {}};
  const auto* end = words[2].data() + words[2].size();
  const auto parsed = std::from_chars(words[2].data(), end, result.count);
  if (parsed.ec != std::errc() || parsed.ptr != end)
    refuse(place, "the PLY header's count '" + std::string(words[2]) + "' of element " + result.name + " is no number");
  return result;
}

PlyProperty property(const std::vector<std::string_view>& words, const std::string& place) {
  if (words.size() == 3) return {std::string(words[2]), scalar(words[1], place), std::nullopt};
  if (words.size() == 5 && words[1] == "list")
    return {std::string(words[4]), scalar(words[3], place), scalar(words[2], place)};
  refuse(place, "the PLY header has a malformed property");
}

// The least number of bytes that one row takes: in ascii a digit and a separator per value.
std::uint64_t least_bytes(const PlyElement& element, PlyFormat format) {
  std::uint64_t bytes = 0;
  for (const auto& p : element.properties)
    bytes += format == PlyFormat::ascii ? 2 : size_of(p.count_type.value_or(p.type));
  return bytes;
}

void check_counts(const PlyHeader& header, std::uint64_t file_bytes, const std::string& place) {
  std::uint64_t left = file_bytes - header.body + 1;  // the last separator of an ascii file may be missing
  for (const auto& element : header.elements) {
    const std::uint64_t bytes = least_bytes(element, header.format);
    if (bytes == 0) continue;
    if (element.count > left / bytes)
      refuse(place, "the header claims " + std::to_string(element.count) + " of element " + element.name +
                        ", which the remaining " + std::to_string(left - 1) + " bytes cannot hold");
    left -= element.count * bytes;
  }
}

}  // namespace

std::size_t size_of(PlyScalar type) {
  for (const auto& s : scalars)
    if (s.type == type) return s.bytes;
  return 0;
}

PlyHeader read_ply_header(std::string_view file, const std::string& place) {
  PlyHeader header;
  bool has_format = false;
  for (std::size_t at = 0, line = 0;; ++line) {
    const auto end = file.find('\n', at);
    if (end == std::string_view::npos) refuse(place, line == 0 ? "is not a PLY file" : "the PLY header is cut off");
    const auto words = words_of(file.substr(at, end - at));
    at = end + 1;
    if (line == 0 && (words.size() != 1 || words[0] != "ply")) refuse(place, "is not a PLY file");
    if (line == 0 || words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") {
      header.body = at;
      break;
    }
    if (words[0] == "format" && words.size() == 3) {
      header.format = format(words[1], place);
      has_format = true;
    } else if (words[0] == "element" && words.size() == 3) {
      header.elements.push_back(element(words, place));
    } else if (words[0] == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(property(words, place));
    } else {
      refuse(place, "line " + std::to_string(line + 1) + " of the PLY header is malformed");
    }
  }
  if (!has_format) refuse(place, "the PLY header names no format");
  check_counts(header, file.size(), place);
  return header;
}

}  // namespace gonio::io
