// A tree of boxes round the triangles of a mesh: nearest points, first hits of rays, neighbours by box. Double
// precision; answers do not depend on threads. inside.h asks every triangle instead, and is what this is held against.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "geom/vector.h"

namespace gonio::mesh {

// The point of triangle abc nearest to p, as weights of the corners (Ericson 2005, Real-Time Collision
// Detection, 5.1.5).
struct ClosestPoint {
  Vec3 point{};
  std::array<double, 3> weights{};
};
ClosestPoint closest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c);

class TriangleTree {
 public:
  // Keeps references: both must stay as they are while the tree is asked. Triangles whose corners are not finite are
  // never met.
  TriangleTree(const std::vector<Vec3>& positions_m, const std::vector<std::array<std::uint32_t, 3>>& triangles);
  TriangleTree(std::vector<Vec3>&&, std::vector<std::array<std::uint32_t, 3>>&&) = delete;

  struct Nearest {
    double distance_m = std::numeric_limits<double>::infinity();  // infinite: nothing within reach
    std::uint32_t triangle = 0;
    ClosestPoint at{};
  };
  Nearest nearest(Vec3 point_m, double within_m = std::numeric_limits<double>::infinity()) const;

  // The first crossing of origin + t direction, t > t_least (Moeller & Trumbore 1997); weights of the corners.
  struct Hit {
    double t = 0;
    std::uint32_t triangle = 0;
    std::array<double, 3> weights{};
  };
  std::optional<Hit> first_hit(Vec3 origin_m, Vec3 direction, double t_least) const;

  // All pairs of triangles whose boxes touch, each once: those of which one is in a leaf and the other in it or in a
  // later one.
  std::size_t leaves() const { return leaves_.size(); }
  void overlapping_pairs(std::size_t leaf, const std::function<void(std::uint32_t, std::uint32_t)>& visit) const;

 private:
  struct Box {
    Vec3 low{}, high{};
  };
  struct Node {
    Box box{};
    std::uint32_t first = 0, count = 0;  // count 0: children are the next node and node `first`
  };
  struct Centre {
    std::array<double, 3> twice{};
    std::uint32_t triangle = 0;
  };
  struct Range {  // of the order that a node, and what is below it, is made of
    std::uint32_t node, first, last;
  };
  static std::uint32_t nodes_of(std::uint32_t triangles);
  static bool touch(const Box& a, const Box& b);
  Box box_of(std::uint32_t triangle) const;
  bool split(const Range& range, std::vector<Centre>& centres, Range& left, Range& right);
  void build(const Range& range, std::vector<Centre>& centres);
  void enclose(std::uint32_t node);

  const std::vector<Vec3>& positions_;
  const std::vector<std::array<std::uint32_t, 3>>& triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;  // depth first
  std::vector<std::uint32_t> leaves_;
};

}  // namespace gonio::mesh
