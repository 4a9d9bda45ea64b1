// See stl.h. Binary: 80 bytes of anything, a count of triangles (32 bit, little endian), and 50 bytes a triangle
// (normal and three corners in single precision, 16 bits of anything). Ascii: facet normal, outer loop, three vertex
// lines, endloop, endfacet between solid and endsolid; words behind endloop and endfacet are
// remarks.
#include "io/stl.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

constexpr std::size_t stl_head = 84, stl_row = 50;

class StlCorners {
 public:
  StlCorners(TriangleMesh& mesh, const std::string& place) : mesh_(mesh), place_(place) {}

  void add(Vec3 corner) {
    if (!is_finite(corner)) refuse("has a corner that is not finite");
    const auto [found, fresh] = index_.try_emplace({corner.x, corner.y, corner.z}, mesh_.positions_m.size());
    if (fresh) mesh_.positions_m.push_back(corner);
    triangle_[count_++ % 3] = static_cast<std::uint32_t>(found->second);
    if (count_ % 3 == 0) mesh_.triangles.push_back(triangle_);
  }
  std::size_t triangles() const { return count_ / 3; }
  [[noreturn]] void refuse(const std::string& problem) const {
    throw Error(Exit::data, place_, "triangle " + std::to_string(count_ / 3) + " " + problem,
                "export or copy it again");
  }

 private:
  TriangleMesh& mesh_;
  const std::string& place_;
  std::map<std::tuple<double, double, double>, std::size_t> index_;
  std::array<std::uint32_t, 3> triangle_{};
  std::size_t count_ = 0;
};

void read_binary(std::string_view file, std::size_t count, StlCorners& corners) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = stl_head + stl_row * i + 12 * (c + 1);
      corners.add({stored_at<float>(file, at), stored_at<float>(file, at + 4), stored_at<float>(file, at + 8)});
    }
}

class StlWords {
 public:
  StlWords(std::string_view text, const StlCorners& corners) : rest_(text), corners_(corners) {}

  std::string_view next() {
    const auto first = rest_.find_first_not_of(blank);
    if (first == std::string_view::npos) corners_.refuse("is cut off");
    rest_.remove_prefix(first);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(blank));
    rest_.remove_prefix(word.size());
    return word;
  }
  void expect(std::string_view word) {
    if (const std::string_view found = next(); found != word)
      corners_.refuse("has \"" + std::string(found.substr(0, 20)) + "\" where \"" + std::string(word) + "\" belongs");
  }
  // What stands between a keyword and the end of its line goes, unless it is what may follow.
  void skip_remark(std::initializer_list<std::string_view> may_follow) {
    const std::string_view here = rest_;
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    if (rest_.substr(0, end).find_first_not_of(blank) == std::string_view::npos) return;
    const std::string_view word = next();
    if (std::find(may_follow.begin(), may_follow.end(), word) == may_follow.end())
      rest_ = here.substr(end);
    else
      rest_ = here;
  }
  double number() {
    std::string_view word = next();
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto end = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end.ec != std::errc{} || end.ptr != word.data() + word.size())
      corners_.refuse("has \"" + std::string(word.substr(0, 20)) + "\" where a number belongs");
    return value;
  }
  void end_line() { rest_.remove_prefix(std::min(rest_.find_first_of("\r\n"), rest_.size())); }
  bool at_end() const { return rest_.find_first_not_of(blank) == std::string_view::npos; }

 private:
  static constexpr std::string_view blank = " \t\r\n";  // lines end as any system ends them
  std::string_view rest_;
  const StlCorners& corners_;
};

void read_facets(StlWords& words, StlCorners& corners) {
  for (std::string_view word = words.next(); word != "endsolid"; word = words.next()) {
    if (word != "facet") corners.refuse("has \"" + std::string(word.substr(0, 20)) + "\" where \"facet\" belongs");
    words.expect("normal");
    for (int i = 0; i < 3; ++i) words.next();  // some writers leave nan there
    words.expect("outer");
    words.expect("loop");
    for (int c = 0; c < 3; ++c) {
      words.expect("vertex");
      const double x = words.number(), y = words.number(), z = words.number();
      corners.add({x, y, z});
    }
    words.expect("endloop");
    words.skip_remark({"endfacet"});
    words.expect("endfacet");
    words.skip_remark({"facet", "endsolid"});
  }
}

// One solid after the other: together they are the mesh.
void read_ascii(std::string_view file, StlCorners& corners) {
  StlWords words(file, corners);
  do {
    words.expect("solid");
    words.end_line();  // its name
    read_facets(words, corners);
    words.end_line();  // its name again
  } while (!words.at_end());
}

}  // namespace

TriangleMesh parse_stl(std::string_view file, const std::string& place) {
  TriangleMesh mesh;
  StlCorners corners(mesh, place);
  const std::size_t count = file.size() >= stl_head ? stored_at<std::uint32_t>(file, stl_head - 4) : 0;
  // Many binary files begin with "solid" too: what the length confirms is binary.
  if (file.size() >= stl_head && (file.size() - stl_head) / stl_row == count && (file.size() - stl_head) % stl_row == 0)
    read_binary(file, count, corners);
  else if (file.starts_with("solid"))
    read_ascii(file, corners);
  else
    throw Error(Exit::data, place,
                "is no STL file: " + std::to_string(file.size()) + " bytes, and its head counts " +
                    std::to_string(count) + " triangles of 50",
                "export or copy it again");
  if (mesh.triangles.empty()) throw Error(Exit::data, place, "has no triangles", "export it again");
  return mesh;
}

TriangleMesh read_stl(const std::filesystem::path& path) {
  return parse_stl(read_file(path), path.filename().string());
}

}  // namespace gonio::io
