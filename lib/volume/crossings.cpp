#include "volume/crossings.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/parallel.h"

namespace gonio::volume {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr double cell_edge = 2;  // voxels

struct Box {
  Vec3 low{}, high{};
};
Box box_of(const std::vector<Vec3>& p, const Triangle& t) {
  Box b{p[t[0]], p[t[0]]};
  for (const std::uint32_t v : {t[1], t[2]}) {
    b.low = {std::min(b.low.x, p[v].x), std::min(b.low.y, p[v].y), std::min(b.low.z, p[v].z)};
    b.high = {std::max(b.high.x, p[v].x), std::max(b.high.y, p[v].y), std::max(b.high.z, p[v].z)};
  }
  return b;
}
bool apart(const Box& a, const Box& b) {
  return a.high.x < b.low.x || b.high.x < a.low.x || a.high.y < b.low.y || b.high.y < a.low.y || a.high.z < b.low.z ||
         b.high.z < a.low.z;
}

// Does the open segment a-b pass through the triangle? Signs of the volumes that they span.
bool pierces(Vec3 a, Vec3 b, Vec3 p, Vec3 q, Vec3 r) {
  const Vec3 n = cross(q - p, r - p);
  const double above = dot(n, a - p), below = dot(n, b - p);
  if (above * below >= 0) return false;
  const Vec3 d = b - a;
  const double one = dot(d, cross(p - a, q - a)), two = dot(d, cross(q - a, r - a)), three = dot(d, cross(r - a, p - a));
  return (one > 0 && two > 0 && three > 0) || (one < 0 && two < 0 && three < 0);
}

int shared_by(const Triangle& a, const Triangle& b) {
  int n = 0;
  for (const std::uint32_t v : a) n += std::ranges::count(b, v) > 0 ? 1 : 0;
  return n;
}
bool has(const Triangle& t, std::uint32_t v) {
  return t[0] == v || t[1] == v || t[2] == v;
}

// Folded flat over the common edge: the third corners lie on one side of it, and the planes are the same.
bool folded(const std::vector<Vec3>& p, const Triangle& a, const Triangle& b) {
  std::uint32_t third_a = a[0], third_b = b[0], one = a[0], two = a[0];
  for (const std::uint32_t v : a)
    if (!has(b, v)) third_a = v;
  for (const std::uint32_t v : b)
    if (!has(a, v)) third_b = v;
  bool first = true;
  for (const std::uint32_t v : a)
    if (v != third_a) (first ? one : two) = v, first = false;
  const Vec3 d = p[two] - p[one], na = cross(d, p[third_a] - p[one]), nb = cross(d, p[third_b] - p[one]);
  const double product = dot(na, nb), lengths = norm(na) * norm(nb);
  return product > 0 && norm(cross(na, nb)) <= 1e-6 * lengths;
}

bool cross_each_other(const std::vector<Vec3>& p, const Triangle& a, const Triangle& b) {
  const int shared = shared_by(a, b);
  if (shared >= 3) return true;
  if (shared == 2) return folded(p, a, b);
  const auto through = [&](const Triangle& one, const Triangle& other) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t u = one[i], v = one[(i + 1) % 3];
      if (has(other, u) || has(other, v)) continue;
      if (pierces(p[u], p[v], p[other[0]], p[other[1]], p[other[2]])) return true;
    }
    return false;
  };
  return through(a, b) || through(b, a);
}

// Triangles by the cells that their boxes touch, sorted by cell.
struct Entry {
  std::uint64_t cell = 0;
  std::uint32_t triangle = 0;
  auto operator<=>(const Entry&) const = default;
};
std::vector<Entry> entries_of(const std::vector<Vec3>& places, const std::vector<Triangle>& triangles) {
  const auto index = [](double x) { return static_cast<std::uint64_t>(std::floor(x / cell_edge) + 0x80000) & 0xfffff; };
  std::vector<Entry> entries;
  entries.reserve(2 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Box b = box_of(places, triangles[t]);
    for (std::uint64_t z = index(b.low.z); z <= index(b.high.z); ++z)
      for (std::uint64_t y = index(b.low.y); y <= index(b.high.y); ++y)
        for (std::uint64_t x = index(b.low.x); x <= index(b.high.x); ++x)
          entries.push_back({(z << 40) | (y << 20) | x, t});
  }
  std::ranges::sort(entries);
  return entries;
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> crossing_triangles(const std::vector<Vec3>& places,
                                                             const std::vector<Triangle>& triangles,
                                                             const std::vector<bool>& stirred) {
  const std::vector<Entry> entries = entries_of(places, triangles);
  std::vector<std::size_t> starts;
  for (std::size_t e = 0; e < entries.size(); ++e)
    if (e == 0 || entries[e].cell != entries[e - 1].cell) starts.push_back(e);
  starts.push_back(entries.size());
  std::vector<bool> moved(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t v : triangles[t]) moved[t] = moved[t] || stirred[v];
  std::vector<std::array<std::uint32_t, 2>> pairs;
  std::mutex adding;
  parallel_for(
      0, starts.size() - 1,
      [&](std::size_t c) {
        for (std::size_t i = starts[c]; i < starts[c + 1]; ++i)
          for (std::size_t j = i + 1; j < starts[c + 1]; ++j) {
            const std::uint32_t a = entries[i].triangle, b = entries[j].triangle;
            if (!moved[a] && !moved[b]) continue;
            if (apart(box_of(places, triangles[a]), box_of(places, triangles[b]))) continue;
            if (!cross_each_other(places, triangles[a], triangles[b])) continue;
            const std::lock_guard lock(adding);
            pairs.push_back({std::min(a, b), std::max(a, b)});
          }
      },
      1024);
  std::ranges::sort(pairs);
  const auto last = std::ranges::unique(pairs);
  pairs.erase(last.begin(), last.end());
  return pairs;
}

}  // namespace gonio::volume
