#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("rounding-math")  // CGAL's interval arithmetic turns the processor's rounding
#endif
#include "mesh/carve/flat_triangulation.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>

namespace gonio::mesh {
namespace {

using Plane = CGAL::Exact_predicates_inexact_constructions_kernel;
using Corner = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Plane>;
using Storage = CGAL::Triangulation_data_structure_2<Corner, CGAL::Constrained_triangulation_face_base_2<Plane>>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<Plane, Storage, CGAL::No_constraint_intersection_tag>;

bool inside_polygon(const std::vector<Vec2>& polygon, Vec2 p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2 a = polygon[i], b = polygon[j];
    if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) inside = !inside;
  }
  return inside;
}

double distance_to(const std::vector<Vec2>& polygon, Vec2 p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2 along = polygon[i] - polygon[j], arm = p - polygon[j];
    const double square = dot(along, along);
    const double t = square > 0 ? std::clamp(dot(arm, along) / square, 0.0, 1.0) : 0;
    least = std::min(least, norm(arm - along * t));
  }
  return least;
}

bool crosses_itself(const std::vector<Vec2>& polygon) {
  const std::size_t n = polygon.size();
  const auto segment = [&](std::size_t i) {
    const Vec2 a = polygon[i], b = polygon[(i + 1) % n];
    return Plane::Segment_2(Plane::Point_2(a.x, a.y), Plane::Point_2(b.x, b.y));
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (polygon[i] == polygon[(i + 1) % n]) return true;
    for (std::size_t j = i + 2; j < n; ++j)
      if ((j + 1) % n != i && CGAL::do_intersect(segment(i), segment(j))) return true;
  }
  return false;
}

// A lattice of equilateral triangles, well off the rim.
std::vector<Vec2> points_inside(const std::vector<Vec2>& polygon, double spacing) {
  Vec2 low = polygon[0], high = low;
  for (const Vec2 p : polygon) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  std::vector<Vec2> points;
  const double row = spacing * std::sqrt(3.0) / 2;
  const auto rows = static_cast<int>((high.y - low.y) / row), columns = static_cast<int>((high.x - low.x) / spacing);
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c <= columns; ++c) {
      const Vec2 p{low.x + spacing * (c + (r % 2 == 1 ? 0.5 : 0.0)), low.y + row * r};
      if (inside_polygon(polygon, p) && distance_to(polygon, p) > 0.6 * spacing) points.push_back(p);
    }
  return points;
}

}  // namespace

FlatTriangulation flat_triangulation(const std::vector<Vec2>& polygon, double spacing) {
  FlatTriangulation flat;
  if (polygon.size() < 3 || crosses_itself(polygon)) return flat;
  flat.inner = points_inside(polygon, spacing);
  Constrained net;
  std::vector<Constrained::Vertex_handle> rim;
  std::uint32_t number = 0;
  for (const Vec2 p : polygon) {
    rim.push_back(net.insert(Plane::Point_2(p.x, p.y)));
    rim.back()->info() = number++;
  }
  for (const Vec2 p : flat.inner) net.insert(Plane::Point_2(p.x, p.y))->info() = number++;
  for (std::size_t i = 0; i < rim.size(); ++i) net.insert_constraint(rim[i], rim[(i + 1) % rim.size()]);
  for (auto face = net.finite_faces_begin(); face != net.finite_faces_end(); ++face) {
    std::array<std::uint32_t, 3> t{};
    Vec2 centre{};
    for (int c = 0; c < 3; ++c) {
      t[static_cast<std::size_t>(c)] = face->vertex(c)->info();
      centre = centre + Vec2{face->vertex(c)->point().x(), face->vertex(c)->point().y()} * (1.0 / 3);
    }
    if (inside_polygon(polygon, centre)) flat.triangles.push_back(t);
  }
  return flat;
}

}  // namespace gonio::mesh
