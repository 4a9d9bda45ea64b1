// The only source of these tests that names CGAL.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <optional>

#include "volume/surfaces.h"

namespace gonio::volume::tests {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Corners = std::array<std::uint32_t, 3>;

// More than the corners and the edge that they share, by CGAL's exact predicates.
bool meet(const std::vector<Point>& points, const Corners& a, const Corners& b) {
  std::vector<std::size_t> shared_a, shared_b;
  for (std::size_t n = 0; n < 3; ++n)
    for (std::size_t m = 0; m < 3; ++m)
      if (a[n] == b[m]) shared_a.push_back(n), shared_b.push_back(m);
  if (shared_a.size() == 3) return true;
  if (shared_a.size() == 2) {  // one folded onto the other
    const Point &p = points[a[shared_a[0]]], &q = points[a[shared_a[1]]];
    const Point &c = points[a[3 - shared_a[0] - shared_a[1]]], &d = points[b[3 - shared_b[0] - shared_b[1]]];
    return CGAL::coplanar(p, q, c, d) && CGAL::coplanar_orientation(p, q, c, d) == CGAL::POSITIVE;
  }
  const auto triangle = [&](const Corners& t) { return Kernel::Triangle_3(points[t[0]], points[t[1]], points[t[2]]); };
  if (shared_a.empty()) return CGAL::do_intersect(triangle(a), triangle(b));
  const auto opposite = [&](const Corners& t, std::size_t n) {
    return Kernel::Segment_3(points[t[(n + 1) % 3]], points[t[(n + 2) % 3]]);
  };
  return CGAL::do_intersect(triangle(a), opposite(b, shared_b[0])) ||
         CGAL::do_intersect(triangle(b), opposite(a, shared_a[0]));
}

}  // namespace

bool intersects_itself(const std::vector<std::array<float, 3>>& positions, const Triangles& triangles) {
  using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::size_t>;
  std::vector<Point> points;
  points.reserve(positions.size());
  for (const auto& p : positions) points.emplace_back(p[0], p[1], p[2]);
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    const Corners& t = triangles[n];
    boxes.emplace_back(points[t[0]].bbox() + points[t[1]].bbox() + points[t[2]].bbox(), n);
  }
  bool found = false;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    found = found || meet(points, triangles[a.info()], triangles[b.info()]);
  });
  return found;
}

}  // namespace gonio::volume::tests
