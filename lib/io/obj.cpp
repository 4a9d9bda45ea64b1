// See obj.h. Lines end with a line feed, a carriage return or both; a backslash at their end continues them. Numbers of
// places count from 1, negative ones back from the last place so far.
#include "io/obj.h"

#include <charconv>
#include <cmath>
#include <cstdint>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/lower_case.h"
#include "io/model_3mf.h"
#include "io/stl.h"

namespace gonio::io {
namespace {

constexpr std::string_view blank = " \t";

class ObjLines {
 public:
  ObjLines(std::string_view text, const std::string& place) : rest_(text), place_(place) {}

  // The next line as one, without what continues it; false at the end.
  bool next(std::string& line) {
    if (rest_.empty()) return false;
    line.clear();
    for (bool goes_on = true; goes_on && !rest_.empty();) {
      const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
      std::string_view part = rest_.substr(0, end);
      rest_.remove_prefix(end);
      rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : rest_.empty() ? 0 : 1);
      ++number_;
      goes_on = part.ends_with('\\');
      if (goes_on) part.remove_suffix(1);
      line += std::string(part) + " ";
    }
    return true;
  }
  [[noreturn]] void refuse(const std::string& problem) const {
    throw Error(Exit::data, place_, "line " + std::to_string(number_) + " " + problem, "export or copy it again");
  }

 private:
  std::string_view rest_;
  const std::string& place_;
  std::size_t number_ = 0;
};

std::string_view word_of(std::string_view& line) {
  const std::size_t first = line.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  line.remove_prefix(first);
  const std::string_view word = line.substr(0, line.find_first_of(blank));
  line.remove_prefix(word.size());
  return word;
}

double number_of(std::string_view word, const ObjLines& lines) {
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  double value = 0;
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || end.ec != std::errc{} || end.ptr != digits.data() + digits.size() || !std::isfinite(value))
    lines.refuse("has \"" + std::string(word.substr(0, 20)) + "\" where a number belongs");
  return value;
}

std::uint32_t place_of(std::string_view word, std::size_t places, const ObjLines& lines) {
  const std::string_view digits = word.substr(0, word.find('/'));
  std::int64_t number = 0;
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (digits.empty() || end.ec != std::errc{} || end.ptr != digits.data() + digits.size())
    lines.refuse("has \"" + std::string(word.substr(0, 20)) + "\" where the number of a place belongs");
  const auto count = static_cast<std::int64_t>(places);
  const std::int64_t at = number > 0 ? number - 1 : count + number;
  if (number == 0 || at < 0 || at >= count)
    lines.refuse("names place " + std::to_string(number) + ", and " + std::to_string(places) + " stand before it");
  return static_cast<std::uint32_t>(at);
}

}  // namespace

TriangleMesh parse_obj(std::string_view file, const std::string& place) {
  TriangleMesh mesh;
  ObjLines lines(file, place);
  std::vector<std::uint32_t> corners;
  for (std::string whole; lines.next(whole);) {
    std::string_view line = whole;
    const std::string_view keyword = word_of(line);
    if (keyword == "v") {
      const double x = number_of(word_of(line), lines), y = number_of(word_of(line), lines),
                   z = number_of(word_of(line), lines);
      mesh.positions_m.push_back({x, y, z});
    } else if (keyword == "f") {
      corners.clear();
      for (std::string_view word = word_of(line); !word.empty(); word = word_of(line))
        corners.push_back(place_of(word, mesh.positions_m.size(), lines));
      if (corners.size() < 3) lines.refuse("has a face of " + std::to_string(corners.size()) + " corners");
      for (std::size_t c = 2; c < corners.size(); ++c)
        mesh.triangles.push_back({corners[0], corners[c - 1], corners[c]});
    }
  }
  if (mesh.triangles.empty()) throw Error(Exit::data, place, "has no faces", "export it again");
  return mesh;
}

TriangleMesh read_obj(const std::filesystem::path& path) {
  return parse_obj(read_file(path), path.filename().string());
}

TriangleMesh read_mesh(const std::filesystem::path& path, bool* in_metres) {
  const std::string extension = lower_case(path.extension().string()), place = path.filename().string();
  if (in_metres != nullptr) *in_metres = extension == ".3mf";
  if (extension == ".3mf") return read_3mf(path);
  const std::string file = read_file(path);
  if (extension == ".obj") return parse_obj(file, place);
  if (extension == ".stl") return parse_stl(file, place);
  if (extension == ".ply" || file.starts_with("ply\n") || file.starts_with("ply\r")) return parse_ply(file, place);
  if (file.starts_with("v ") || file.find("\nv ") != std::string::npos) return parse_obj(file, place);
  return parse_stl(file, place);
}

}  // namespace gonio::io
