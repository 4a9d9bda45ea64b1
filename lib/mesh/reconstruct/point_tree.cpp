#include "mesh/reconstruct/point_tree.h"

#include <algorithm>
#include <numeric>

namespace gonio::mesh {
namespace {

constexpr std::uint32_t leaf_points = 12;

double squared_length(Vec3 v) {
  return dot(v, v);
}

}  // namespace

PointTree::PointTree(std::vector<Vec3> points) : points_(std::move(points)), order_(points_.size()) {
  std::iota(order_.begin(), order_.end(), std::uint32_t{0});
  if (!points_.empty()) build(0, static_cast<std::uint32_t>(points_.size()));
  ordered_.reserve(points_.size());
  for (const std::uint32_t i : order_) ordered_.push_back(points_[i]);
}

std::uint32_t PointTree::build(std::uint32_t first, std::uint32_t last) {
  const auto own = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({first, last});
  if (last - first <= leaf_points) return own;
  Vec3 low = points_[order_[first]], high = low;
  for (std::uint32_t i = first; i < last; ++i) {
    const Vec3 p = points_[order_[i]];
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 side = high - low;
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double x = points_[a][axis], y = points_[b][axis];
                     return x != y ? x < y : a < b;
                   });
  const double plane = points_[order_[middle]][axis];
  build(first, middle);
  const std::uint32_t second = build(middle, last);
  nodes_[own].second = second, nodes_[own].axis = axis, nodes_[own].plane = plane;
  return own;
}

void PointTree::search(std::uint32_t node, Vec3 at, std::size_t count, std::vector<Neighbour>& heap) const {
  const Node& n = nodes_[node];
  if (n.second == 0) {
    for (std::uint32_t i = n.first; i < n.last; ++i) {
      const Neighbour one{squared_length(ordered_[i] - at), order_[i]};
      if (heap.size() == count) {
        if (!(one < heap.front())) continue;
        std::ranges::pop_heap(heap);
        heap.back() = one;
      } else {
        heap.push_back(one);
      }
      std::ranges::push_heap(heap);
    }
    return;
  }
  const double off = at[n.axis] - n.plane;
  search(off < 0 ? node + 1 : n.second, at, count, heap);
  if (heap.size() < count || off * off <= heap.front().squared) search(off < 0 ? n.second : node + 1, at, count, heap);
}

void PointTree::nearest(Vec3 at, std::size_t count, std::vector<Neighbour>& found) const {
  found.clear();
  if (nodes_.empty() || count == 0) return;
  search(0, at, count, found);
  std::ranges::sort_heap(found);
}

void PointTree::visit_within(std::uint32_t node, Vec3 at, double squared,
                             const std::function<void(std::uint32_t)>& visit) const {
  const Node& n = nodes_[node];
  if (n.second == 0) {
    for (std::uint32_t i = n.first; i < n.last; ++i)
      if (squared_length(ordered_[i] - at) <= squared) visit(order_[i]);
    return;
  }
  const double off = at[n.axis] - n.plane;
  if (off <= 0 || off * off <= squared) visit_within(node + 1, at, squared, visit);
  if (off >= 0 || off * off <= squared) visit_within(n.second, at, squared, visit);
}

void PointTree::within(Vec3 at, double distance, const std::function<void(std::uint32_t)>& visit) const {
  if (!nodes_.empty()) visit_within(0, at, distance * distance, visit);
}

}  // namespace gonio::mesh
