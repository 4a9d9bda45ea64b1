// Split at the median centre of the longest side, down to leaves of four triangles; nodes depth first.
#include "mesh/triangle_tree.h"

#include <algorithm>
#include <cmath>

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
  std::vector<Box> boxes(triangles.size());
  order_.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    if (!is_finite(positions_m[a]) || !is_finite(positions_m[b]) || !is_finite(positions_m[c])) continue;
    boxes[t] = box_of(t);
    order_.push_back(t);
  }
  if (order_.empty()) return;
  nodes_.reserve(order_.size());
  build(0, static_cast<std::uint32_t>(order_.size()), boxes);
}

void TriangleTree::build(std::uint32_t first, std::uint32_t last, const std::vector<Box>& boxes) {
  Box box = boxes[order_[first]];
  Vec3 least = box.low + box.high, most = least;  // twice the centres
  for (std::uint32_t i = first + 1; i < last; ++i) {
    const Box& one = boxes[order_[i]];
    box = {lower(box.low, one.low), upper(box.high, one.high)};
    least = lower(least, one.low + one.high);
    most = upper(most, one.low + one.high);
  }
  const std::size_t here = nodes_.size();
  nodes_.push_back({box, first, last - first});
  if (last - first <= leaf_triangles) return;
  const Vec3 extent = most - least;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double x = boxes[a].low[axis] + boxes[a].high[axis];
                     const double y = boxes[b].low[axis] + boxes[b].high[axis];
                     return x != y ? x < y : a < b;
                   });
  build(first, middle, boxes);
  nodes_[here].count = 0;
  nodes_[here].first = static_cast<std::uint32_t>(nodes_.size());
  build(middle, last, boxes);
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

void TriangleTree::overlapping_after(std::uint32_t triangle, const std::function<void(std::uint32_t)>& visit) const {
  if (nodes_.empty()) return;
  const Box box = box_of(triangle);
  const auto apart = [&](const Box& o) {
    return o.high.x < box.low.x || box.high.x < o.low.x || o.high.y < box.low.y || box.high.y < o.low.y ||
           o.high.z < box.low.z || box.high.z < o.low.z;
  };
  std::array<std::uint32_t, deepest> stack;
  std::size_t height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const std::uint32_t at = stack[--height];
    const Node& node = nodes_[at];
    if (apart(node.box)) continue;
    if (node.count == 0) {
      stack[height++] = node.first;
      stack[height++] = at + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      if (order_[i] > triangle && !apart(box_of(order_[i]))) visit(order_[i]);
  }
}

}  // namespace gonio::mesh
