// See pixel_neighbours.h.
#include "mesh/pixel_neighbours.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

#include "stats/intervals.h"

namespace gonio::mesh {

io::TriangleMesh joined_neighbours(const std::vector<Vec3>& points_m, const std::vector<Vec2>& pixels, double longest) {
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> at;  // by row and column
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Vec2 whole{std::round(pixels[i].x), std::round(pixels[i].y)};
    if (norm(pixels[i] - whole) < 1e-3)
      at.try_emplace({static_cast<std::int64_t>(whole.y), static_cast<std::int64_t>(whole.x)}, i);
  }
  const auto there = [&at](std::int64_t row, std::int64_t column) -> std::optional<std::size_t> {
    const auto found = at.find({row, column});
    return found == at.end() ? std::nullopt : std::optional(found->second);
  };
  const auto length = [&points_m](std::size_t a, std::size_t b) { return norm(points_m[a] - points_m[b]); };
  std::vector<double> edges;
  for (const auto& [place, own] : at)
    if (const auto right = there(place.first, place.second + 1)) edges.push_back(length(own, *right));
  io::TriangleMesh mesh;
  if (edges.empty()) return mesh;
  const double most = longest * stats::median(edges);
  std::map<std::size_t, std::uint32_t> kept;
  const auto vertex = [&](std::size_t i) {
    const auto [place, fresh] = kept.try_emplace(i, static_cast<std::uint32_t>(mesh.positions_m.size()));
    if (fresh) mesh.positions_m.push_back(points_m[i]);
    return place->second;
  };
  const auto add = [&](std::optional<std::size_t> a, std::optional<std::size_t> b, std::optional<std::size_t> c) {
    if (!a || !b || !c || length(*a, *b) > most || length(*b, *c) > most || length(*c, *a) > most) return;
    mesh.triangles.push_back({vertex(*a), vertex(*b), vertex(*c)});
  };
  // Cells by their upper left corner; where that has no point, by the upper right one.
  for (std::int64_t row = at.begin()->first.first; row <= at.rbegin()->first.first; ++row)
    for (auto i = at.lower_bound({row, INT64_MIN}); i != at.end() && i->first.first == row; ++i) {
      const std::int64_t column = i->first.second;
      if (!there(row, column - 1)) add(i->second, there(row + 1, column - 1), there(row + 1, column));
      const auto right = there(row, column + 1), below = there(row + 1, column), across = there(row + 1, column + 1);
      if (right && below) {
        add(i->second, below, right), add(right, below, across);
      } else {
        add(i->second, below, across), add(i->second, across, right);
      }
    }
  return mesh;
}

}  // namespace gonio::mesh
