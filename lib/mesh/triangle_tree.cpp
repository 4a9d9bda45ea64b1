// Split at the median centre of the longest side, down to leaves of four triangles; nodes depth first.
#include "mesh/triangle_tree.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace gonio::mesh {
namespace {

constexpr std::uint32_t leaf_triangles = 4;
constexpr std::size_t deepest = 64;  // of the stacks: a median split of 2^32 triangles has 31 levels

Vec3 lower(Vec3 a, Vec3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
Vec3 upper(Vec3 a, Vec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

double squared_outside(Vec3 p, Vec3 low, Vec3 high) {
  const auto gap = [](double x, double l, double h) { return std::max({l - x, x - h, 0.0}); };
  const double x = gap(p.x, low.x, high.x), y = gap(p.y, low.y, high.y), z = gap(p.z, low.z, high.z);
  return x * x + y * y + z * z;
}

// Where a ray enters a box, infinity where it does not before t_most. Along an axis in which it does not move (whose
// inverse is infinite) it is between the planes or never.
double enters(Vec3 origin, Vec3 inverse, double t_most, Vec3 low, Vec3 high) {
  double t0 = 0, t1 = t_most;
  for (int i = 0; i < 3; ++i) {
    if (std::isinf(inverse[i])) {
      if (origin[i] < low[i] || origin[i] > high[i]) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double a = (low[i] - origin[i]) * inverse[i], b = (high[i] - origin[i]) * inverse[i];
    const double near = a < b ? a : b, far = a < b ? b : a;
    if (near > t0) t0 = near;
    if (far < t1) t1 = far;
  }
  return t0 <= t1 * (1 + 4e-16) ? t0 : std::numeric_limits<double>::infinity();
}

}  // namespace

ClosestPoint closest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const auto mix = [&](double u, double v, double w) { return ClosestPoint{a * u + b * v + c * w, {u, v, w}}; };
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return mix(1, 0, 0);
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return mix(0, 1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return mix(1 - d1 / (d1 - d3), d1 / (d1 - d3), 0);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return mix(0, 0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return mix(1 - d2 / (d2 - d6), 0, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6 && d4 - d3 + d5 - d6 > 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return mix(0, 1 - w, w);
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return mix(1, 0, 0);  // all three corners at one place
  return mix(va / sum, vb / sum, vc / sum);
}

TriangleTree::Box TriangleTree::box_of(std::uint32_t triangle) const {
  const auto& t = triangles_[triangle];
  const Vec3 a = positions_[t[0]], b = positions_[t[1]], c = positions_[t[2]];
  return {lower(a, lower(b, c)), upper(a, upper(b, c))};
}

TriangleTree::TriangleTree(const std::vector<Vec3>& positions_m,
                           const std::vector<std::array<std::uint32_t, 3>>& triangles)
    : positions_(positions_m), triangles_(triangles) {
  std::vector<Centre> centres;
  centres.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    if (!is_finite(positions_m[a]) || !is_finite(positions_m[b]) || !is_finite(positions_m[c])) continue;
    const Box box = box_of(t);
    const Vec3 twice = box.low + box.high;
    centres.push_back({{twice.x, twice.y, twice.z}, t});
  }
  if (centres.empty()) return;
  const auto count = static_cast<std::uint32_t>(centres.size());
  nodes_.resize(nodes_of(count));
  order_.resize(count);
  // The upper levels one after the other, each in parallel; what hangs below them each by itself.
  std::vector<Range> level{{0, 0, count}}, below;
  std::vector<std::uint32_t> upper;
  for (int depth = 0; depth < 5; ++depth) {
    std::vector<std::array<Range, 2>> halves(level.size());
    std::vector<std::uint8_t> is_split(level.size(), 0);
    parallel_for(0, level.size(),
                 [&](std::size_t n) { is_split[n] = split(level[n], centres, halves[n][0], halves[n][1]); });
    std::vector<Range> next;
    for (std::size_t n = 0; n < level.size(); ++n)
      if (is_split[n] != 0) {
        upper.push_back(level[n].node);
        next.insert(next.end(), halves[n].begin(), halves[n].end());
      } else {
        below.push_back(level[n]);
      }
    level.swap(next);
  }
  below.insert(below.end(), level.begin(), level.end());
  parallel_for(0, below.size(), [&](std::size_t n) { build(below[n], centres); });
  for (auto node = upper.rbegin(); node != upper.rend(); ++node) enclose(*node);
  for (std::uint32_t n = 0; n < nodes_.size(); ++n)
    if (nodes_[n].count > 0) leaves_.push_back(n);
}

// How many nodes a tree of so many triangles has: halves are as large as each other or one apart, so that a level knows
// two sizes only.
std::uint32_t TriangleTree::nodes_of(std::uint32_t triangles) {
  struct Pair {
    std::uint32_t here, next;  // of n, and of n + 1 triangles
  };
  const auto pair_of = [](const auto& self, std::uint32_t n) -> Pair {
    if (n < leaf_triangles) return {1, 1};
    const Pair half = self(self, n / 2);
    const std::uint32_t even = 1 + 2 * half.here, odd = 1 + half.here + half.next, after = 1 + 2 * half.next;
    if (n % 2 == 1) return {odd, after};
    return {n == leaf_triangles ? 1 : even, odd};
  };
  return pair_of(pair_of, triangles).here;
}

// False where the range is a leaf's.
bool TriangleTree::split(const Range& range, std::vector<Centre>& centres, Range& left, Range& right) {
  const auto [node, first, last] = range;
  if (last - first <= leaf_triangles) return false;
  std::array<double, 3> least = centres[first].twice, most = least;
  for (std::uint32_t i = first + 1; i < last; ++i)
    for (std::size_t a = 0; a < 3; ++a) {
      least[a] = std::min(least[a], centres[i].twice[a]);
      most[a] = std::max(most[a], centres[i].twice[a]);
    }
  const std::array<double, 3> extent{most[0] - least[0], most[1] - least[1], most[2] - least[2]};
  const std::size_t axis = extent[0] >= extent[1] && extent[0] >= extent[2] ? 0 : extent[1] >= extent[2] ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(centres.begin() + first, centres.begin() + middle, centres.begin() + last,
                   [axis](const Centre& a, const Centre& b) {
                     return a.twice[axis] != b.twice[axis] ? a.twice[axis] < b.twice[axis] : a.triangle < b.triangle;
                   });
  left = {node + 1, first, middle};
  right = {node + 1 + nodes_of(middle - first), middle, last};
  nodes_[node].first = right.node;
  return true;
}

void TriangleTree::build(const Range& range, std::vector<Centre>& centres) {
  Range left{}, right{};
  if (split(range, centres, left, right)) {
    build(left, centres);
    build(right, centres);
    enclose(range.node);
    return;
  }
  Node& leaf = nodes_[range.node];
  leaf.first = range.first, leaf.count = range.last - range.first;
  for (std::uint32_t i = range.first; i < range.last; ++i) {
    order_[i] = centres[i].triangle;
    const Box box = box_of(order_[i]);
    leaf.box = i == range.first ? box : Box{lower(leaf.box.low, box.low), upper(leaf.box.high, box.high)};
  }
}

void TriangleTree::enclose(std::uint32_t node) {
  const Box &left = nodes_[node + 1].box, &right = nodes_[nodes_[node].first].box;
  nodes_[node].box = {lower(left.low, right.low), upper(left.high, right.high)};
}

TriangleTree::Nearest TriangleTree::nearest(Vec3 point_m, double within_m) const {
  Nearest best;
  double limit = within_m * within_m;
  if (nodes_.empty()) return best;
  struct Waiting {
    std::uint32_t node;
    double squared;
  };
  std::array<Waiting, deepest> stack;
  std::size_t height = 0;
  stack[height++] = {0, squared_outside(point_m, nodes_[0].box.low, nodes_[0].box.high)};
  while (height > 0) {
    const Waiting top = stack[--height];
    if (top.squared > limit) continue;
    const Node& node = nodes_[top.node];
    if (node.count == 0) {
      const std::uint32_t left = top.node + 1, right = node.first;
      const double a = squared_outside(point_m, nodes_[left].box.low, nodes_[left].box.high);
      const double b = squared_outside(point_m, nodes_[right].box.low, nodes_[right].box.high);
      stack[height++] = a < b ? Waiting{right, b} : Waiting{left, a};
      stack[height++] = a < b ? Waiting{left, a} : Waiting{right, b};
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const auto& t = triangles_[order_[i]];
      const ClosestPoint at = closest_on_triangle(point_m, positions_[t[0]], positions_[t[1]], positions_[t[2]]);
      const Vec3 gap = point_m - at.point;
      const double squared = dot(gap, gap);
      const bool nearer = squared < limit || (squared == limit && order_[i] < best.triangle);
      if (!(squared <= limit) || (std::isfinite(best.distance_m) && !nearer)) continue;
      limit = squared;
      best = {std::sqrt(squared), order_[i], at};
    }
  }
  return best;
}

std::optional<TriangleTree::Hit> TriangleTree::first_hit(Vec3 origin_m, Vec3 direction, double t_least) const {
  std::optional<Hit> best;
  if (nodes_.empty()) return best;
  const Vec3 inverse{1 / direction.x, 1 / direction.y, 1 / direction.z};
  double limit = std::numeric_limits<double>::infinity();
  std::array<std::uint32_t, deepest> stack;
  std::size_t height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const std::uint32_t at = stack[--height];
    const Node& node = nodes_[at];
    if (std::isinf(enters(origin_m, inverse, limit, node.box.low, node.box.high))) continue;
    if (node.count == 0) {
      const std::uint32_t left = at + 1, right = node.first;
      const bool left_first = enters(origin_m, inverse, limit, nodes_[left].box.low, nodes_[left].box.high) <=
                              enters(origin_m, inverse, limit, nodes_[right].box.low, nodes_[right].box.high);
      stack[height++] = left_first ? right : left;
      stack[height++] = left_first ? left : right;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const auto& t = triangles_[order_[i]];
      const Vec3 a = positions_[t[0]], ab = positions_[t[1]] - a, ac = positions_[t[2]] - a;
      const Vec3 p = cross(direction, ac);
      const double determinant = dot(ab, p);
      if (determinant == 0) continue;
      const Vec3 arm = origin_m - a, q = cross(arm, ab);
      const double u = dot(arm, p) / determinant, v = dot(direction, q) / determinant;
      const double t_hit = dot(ac, q) / determinant;
      if (u < 0 || v < 0 || u + v > 1 || !(t_hit > t_least) || t_hit > limit) continue;
      if (t_hit == limit && best && order_[i] > best->triangle) continue;
      limit = t_hit;
      best = Hit{t_hit, order_[i], {1 - u - v, u, v}};
    }
  }
  return best;
}

bool TriangleTree::touch(const Box& a, const Box& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

void TriangleTree::overlapping_pairs(std::size_t leaf,
                                     const std::function<void(std::uint32_t, std::uint32_t)>& visit) const {
  const std::uint32_t own = leaves_[leaf];
  const Node& mine = nodes_[own];
  std::array<Box, leaf_triangles> boxes{};
  for (std::uint32_t i = 0; i < mine.count; ++i) boxes[i] = box_of(order_[mine.first + i]);
  for (std::uint32_t i = 0; i < mine.count; ++i)
    for (std::uint32_t j = i + 1; j < mine.count; ++j)
      if (touch(boxes[i], boxes[j])) visit(order_[mine.first + i], order_[mine.first + j]);
  std::array<std::uint32_t, deepest> stack;
  std::size_t height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const std::uint32_t at = stack[--height];
    const Node& node = nodes_[at];
    if (!touch(node.box, mine.box)) continue;
    if (node.count == 0) {
      stack[height++] = node.first;
      if (node.first > own) stack[height++] = at + 1;  // else all that is to the left comes before
      continue;
    }
    if (at <= own) continue;
    for (std::uint32_t j = node.first; j < node.first + node.count; ++j) {
      const Box other = box_of(order_[j]);
      if (!touch(other, mine.box)) continue;
      for (std::uint32_t i = 0; i < mine.count; ++i)
        if (touch(boxes[i], other)) visit(order_[mine.first + i], order_[j]);
    }
  }
}

}  // namespace gonio::mesh
