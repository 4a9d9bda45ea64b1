// A closed triangle mesh as a shape: all crossings of a ray by a tree of boxes, paired by their orientation.
//
// Watertight: which side of an edge a ray passes is decided by the edge alone, from its ends in a fixed order (Woop,
// Benthin & Wald 2013, in spirit), so that two triangles of an edge never both miss a ray nor both take it. A ray that
// touches an edge or a corner to the last bit is moved by a hair.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "ct/shape.h"

namespace gonio::ct {
namespace {

using Corners = std::array<std::uint32_t, 3>;

struct MeshBox {
  Vec3 lo{HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  void take(Vec3 p) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  double distance(Vec3 p) const {
    const Vec3 d{std::max({lo.x - p.x, p.x - hi.x, 0.0}), std::max({lo.y - p.y, p.y - hi.y, 0.0}),
                 std::max({lo.z - p.z, p.z - hi.z, 0.0})};
    return norm(d);
  }
};

struct MeshNode {
  MeshBox box;
  std::uint32_t first = 0, count = 0;  // count 0: children at `first` and `first` + 1
};

// Ericson, Real-Time Collision Detection (2005), 5.1.5.
Vec3 closest_on(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (c - b) * ((d4 - d3) / (d4 - d3 + d5 - d6));
  return a + ab * (vb / (va + vb + vc)) + ac * (vc / (va + vb + vc));
}

class MeshShape final : public Shape {
 public:
  MeshShape(std::vector<Vec3> positions, std::vector<Corners> triangles)
      : positions_(std::move(positions)), triangles_(std::move(triangles)) {
    if (triangles_.empty()) throw std::invalid_argument("a mesh without triangles");
    for (const Corners& t : triangles_)
      for (const std::uint32_t v : t) whole_.take(positions_.at(v));
    nodes_.emplace_back();
    split(0, 0, triangles_.size());
  }

  void cut(const Ray& given, Spans& into) const override {
    Ray ray = given;
    const double size = norm(whole_.hi - whole_.lo);
    std::vector<Hit>& hits = scratch();
    for (int attempt = 0; attempt < 8; ++attempt) {
      hits.clear();
      if (collect(ray, hits) && pair(hits, into)) return;
      into.clear();
      ray.origin += Vec3{0.61, 0.23, 0.76} * (1e-10 * size * (attempt + 1));
    }
    throw std::invalid_argument("the mesh is not closed or not oriented");
  }
  double distance(Vec3 p) const override {
    double best = HUGE_VAL;
    std::vector<std::uint32_t> todo{0};
    while (!todo.empty()) {
      const MeshNode& node = nodes_[todo.back()];
      todo.pop_back();
      if (node.box.distance(p) >= best) continue;
      for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
        const Corners& t = triangles_[k];
        best = std::min(best, norm(p - closest_on(p, positions_[t[0]], positions_[t[1]], positions_[t[2]])));
      }
      if (node.count > 0) continue;
      const bool second = nodes_[node.first + 1].box.distance(p) < nodes_[node.first].box.distance(p);
      todo.push_back(second ? node.first : node.first + 1);
      todo.push_back(second ? node.first + 1 : node.first);
    }
    Spans spans;
    cut({p, normalized({0.5377, 0.8339, 0.1276})}, spans);
    bool inside = false;
    for (int k = 0; k < spans.count(); ++k) inside = inside || (spans.enter(k) <= 0 && spans.leave(k) > 0);
    return inside ? -best : best;
  }
  Ball bound() const override { return {(whole_.lo + whole_.hi) * 0.5, norm(whole_.hi - whole_.lo) / 2}; }

 private:
  struct Hit {
    double t;
    int turn;  // +1 enters, -1 leaves
  };
  static std::vector<Hit>& scratch() {
    thread_local std::vector<Hit> hits;
    return hits;
  }

  void split(std::size_t at, std::size_t first, std::size_t last) {
    MeshBox box, centres;
    for (std::size_t k = first; k < last; ++k) {
      for (const std::uint32_t v : triangles_[k]) box.take(positions_[v]);
      centres.take(middle(triangles_[k]));
    }
    nodes_[at].box = box;
    if (last - first <= 4) {
      nodes_[at].first = static_cast<std::uint32_t>(first), nodes_[at].count = static_cast<std::uint32_t>(last - first);
      return;
    }
    const Vec3 extent = centres.hi - centres.lo;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::size_t half = (first + last) / 2;
    const auto at_index = [&](std::size_t k) { return triangles_.begin() + static_cast<long>(k); };
    std::nth_element(at_index(first), at_index(half), at_index(last),
                     [&](const Corners& a, const Corners& b) { return middle(a)[axis] < middle(b)[axis]; });
    const std::size_t child = nodes_.size();
    nodes_[at].first = static_cast<std::uint32_t>(child);
    nodes_.resize(child + 2);
    split(child, first, half);
    split(child + 1, half, last);
  }
  Vec3 middle(const Corners& t) const { return (positions_[t[0]] + positions_[t[1]] + positions_[t[2]]) / 3; }

  static bool reaches(const MeshBox& box, const Ray& ray) {
    double enter = -HUGE_VAL, leave = HUGE_VAL;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = ray.direction[axis], lo = box.lo[axis] - ray.origin[axis], hi = box.hi[axis] - ray.origin[axis];
      if (d == 0) {
        if (lo > 0 || hi < 0) return false;
        continue;
      }
      enter = std::max(enter, std::min(lo / d, hi / d)), leave = std::min(leave, std::max(lo / d, hi / d));
    }
    return enter <= leave * (1 + 1e-12) + 1e-12;
  }

  // On which side of the edge the ray passes: the same number, up to its sign, whoever asks.
  double side(std::uint32_t a, std::uint32_t b, const Ray& ray) const {
    const bool ordered = a < b;
    const Vec3 p = positions_[ordered ? a : b] - ray.origin, q = positions_[ordered ? b : a] - ray.origin;
    const double value = dot(ray.direction, cross(p, q));
    return ordered ? value : -value;
  }

  // False: the ray touches an edge.
  bool collect(const Ray& ray, std::vector<Hit>& hits) const {
    std::array<std::uint32_t, 64> todo;
    std::size_t waiting = 0;
    todo[waiting++] = 0;
    while (waiting > 0) {
      const MeshNode& node = nodes_[todo[--waiting]];
      if (!reaches(node.box, ray)) continue;
      if (node.count == 0) {
        todo[waiting++] = node.first, todo[waiting++] = node.first + 1;
        continue;
      }
      for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
        const Corners& t = triangles_[k];
        const double u = side(t[0], t[1], ray), v = side(t[1], t[2], ray), w = side(t[2], t[0], ray);
        const bool all = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
        if (!all) continue;
        if (u == 0 || v == 0 || w == 0) {
          if (u == 0 && v == 0 && w == 0) continue;  // seen edge on
          return false;
        }
        const Vec3 a = positions_[t[0]], n = cross(positions_[t[1]] - a, positions_[t[2]] - a);
        const double slope = dot(n, ray.direction);
        if (slope == 0) return false;
        hits.push_back({dot(n, a - ray.origin) / slope, u > 0 ? -1 : 1});
      }
    }
    return true;
  }

  static bool pair(std::vector<Hit>& hits, Spans& into) {
    std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.t < b.t; });
    int depth = 0;
    double from = 0;
    for (const Hit& h : hits) {
      if (depth == 0) from = h.t;
      depth += h.turn;
      if (depth == 0) into.add(std::min(from, h.t), std::max(from, h.t));
    }
    return depth == 0;
  }

  std::vector<Vec3> positions_;
  std::vector<Corners> triangles_;
  std::vector<MeshNode> nodes_;
  MeshBox whole_;
};

}  // namespace

ShapePtr of_mesh(std::vector<Vec3> positions, std::vector<std::array<std::uint32_t, 3>> triangles) {
  return std::make_shared<MeshShape>(std::move(positions), std::move(triangles));
}

}  // namespace gonio::ct
