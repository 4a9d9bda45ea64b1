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

  // Triangles whose boxes touch that of `triangle` and that come after it.
  void overlapping_after(std::uint32_t triangle, const std::function<void(std::uint32_t)>& visit) const;

 private:
  struct Box {
    Vec3 low{}, high{};
  };
  struct Node {
    Box box{};
    std::uint32_t first = 0, count = 0;  // count 0: children are the next node and node `first`
  };
  Box box_of(std::uint32_t triangle) const;
  void build(std::uint32_t first, std::uint32_t last, const std::vector<Box>& boxes);

  const std::vector<Vec3>& positions_;
  const std::vector<std::array<std::uint32_t, 3>>& triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace gonio::mesh
