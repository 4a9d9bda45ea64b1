// A k-d tree of points (Bentley 1975; split at the median of the longest side): nearest neighbours, and all within a
// distance. Double precision; ties go to the smaller index, so answers do not depend on how it was built.
#pragma once
#include <compare>
#include <cstdint>
#include <functional>
#include <vector>

#include "geom/vector.h"

namespace gonio::mesh {

class PointTree {
 public:
  struct Neighbour {
    double squared = 0;  // distance
    std::uint32_t point = 0;
    auto operator<=>(const Neighbour&) const = default;
  };

  explicit PointTree(std::vector<Vec3> points);
  // The `count` nearest, nearest first; fewer where there are fewer. `found` is emptied first.
  void nearest(Vec3 at, std::size_t count, std::vector<Neighbour>& found) const;
  void within(Vec3 at, double distance, const std::function<void(std::uint32_t)>& visit) const;
  std::size_t size() const { return points_.size(); }
  const Vec3& operator[](std::uint32_t point) const { return points_[point]; }

 private:
  struct Node {
    std::uint32_t first = 0, last = 0;  // of order_
    std::uint32_t second = 0;           // child beyond the plane, the other is the next node; 0: a leaf
    int axis = 0;
    double plane = 0;
  };
  std::uint32_t build(std::uint32_t first, std::uint32_t last);
  void search(std::uint32_t node, Vec3 at, std::size_t count, std::vector<Neighbour>& heap) const;
  void visit_within(std::uint32_t node, Vec3 at, double squared, const std::function<void(std::uint32_t)>& visit) const;

  std::vector<Vec3> points_;
  std::vector<std::uint32_t> order_;
  std::vector<Vec3> ordered_;  // points_ by order_: a leaf is read in one go
  std::vector<Node> nodes_;
};

}  // namespace gonio::mesh
