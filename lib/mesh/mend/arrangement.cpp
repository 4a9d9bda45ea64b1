// Pairs that meet are found by self_intersections(). Each triangle of them is triangulated anew, in its plane seen
// along the axis that it is most square to, with its edges and its intersections as constraints (CGAL). Points are the
// same where their exact coordinates are: those on an edge come out alike from the triangles on its both sides.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("rounding-math")  // CGAL's interval arithmetic turns the processor's rounding
#endif
#include "mesh/mend/arrangement.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <variant>

#include "mesh/topology.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Exact::Point_3;
using Flat = Exact::Point_2;
using Storage = CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_2<Exact>,
                                                     CGAL::Constrained_triangulation_face_base_2<Exact>>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<Exact, Storage, CGAL::Exact_intersections_tag>;

constexpr std::size_t most_pairs = std::size_t{1} << 22;

Point exact(Vec3 p) {
  return {p.x, p.y, p.z};
}
Exact::Triangle_3 exact(const io::TriangleMesh& mesh, std::uint32_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {exact(mesh.positions_m[a]), exact(mesh.positions_m[b]), exact(mesh.positions_m[c])};
}

// What others leave on one triangle.
struct Marks3 {
  std::vector<Point> points;
  std::vector<std::array<Point, 2>> segments;
  std::vector<std::uint32_t> coplanar;  // that lie in its plane and on it
};

// A triangle's plane seen along an axis.
class View {
 public:
  explicit View(const Exact::Triangle_3& t) : plane_(t.supporting_plane()) {
    const std::array<double, 3> n{std::abs(CGAL::to_double(plane_.a())), std::abs(CGAL::to_double(plane_.b())),
                                  std::abs(CGAL::to_double(plane_.c()))};
    axis_ = static_cast<int>(std::max_element(n.begin(), n.end()) - n.begin());
    const Exact::FT along = axis_ == 0 ? plane_.a() : axis_ == 1 ? plane_.b() : plane_.c();
    reversed_ = along < 0;
  }
  Flat flat(const Point& p) const {
    return axis_ == 0 ? Flat(p.y(), p.z()) : axis_ == 1 ? Flat(p.z(), p.x()) : Flat(p.x(), p.y());
  }
  Point lifted(const Flat& q) const {
    const Exact::FT &u = q.x(), &v = q.y();
    if (axis_ == 0) return {-(plane_.b() * u + plane_.c() * v + plane_.d()) / plane_.a(), u, v};
    if (axis_ == 1) return {v, -(plane_.c() * u + plane_.a() * v + plane_.d()) / plane_.b(), u};
    return {u, v, -(plane_.a() * u + plane_.b() * v + plane_.d()) / plane_.c()};
  }
  bool reversed() const { return reversed_; }  // the triangle turns clockwise in it

 private:
  Exact::Plane_3 plane_;
  int axis_ = 2;
  bool reversed_ = false;
};

class Vertices {
 public:
  explicit Vertices(std::vector<Vec3>& positions) : positions_(positions) {}
  std::uint32_t of(const Point& p) {
    const auto [at, fresh] = numbers_.try_emplace(p, static_cast<std::uint32_t>(positions_.size()));
    if (fresh) positions_.push_back({CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())});
    return at->second;
  }

 private:
  std::map<Point, std::uint32_t> numbers_;
  std::vector<Vec3>& positions_;
};

void mark(std::map<std::uint32_t, Marks3>& marks, std::uint32_t a, std::uint32_t b, const io::TriangleMesh& mesh) {
  const auto common = CGAL::intersection(exact(mesh, a), exact(mesh, b));
  if (!common) return;
  std::vector<Point> outline;
  if (const Point* p = boost::get<Point>(&*common)) outline = {*p};
  if (const Exact::Segment_3* s = boost::get<Exact::Segment_3>(&*common)) outline = {s->source(), s->target()};
  if (const Exact::Triangle_3* t = boost::get<Exact::Triangle_3>(&*common)) outline = {(*t)[0], (*t)[1], (*t)[2]};
  if (const std::vector<Point>* p = boost::get<std::vector<Point>>(&*common)) outline = *p;
  for (const std::uint32_t mine : {a, b}) {
    Marks3& own = marks[mine];
    if (outline.size() == 1) own.points.push_back(outline[0]);
    if (outline.size() == 2) own.segments.push_back({outline[0], outline[1]});
    for (std::size_t i = 0; outline.size() > 2 && i < outline.size(); ++i)
      own.segments.push_back({outline[i], outline[(i + 1) % outline.size()]});
    if (outline.size() > 2) own.coplanar.push_back(a + b - mine);
  }
}

// Those of `others` in which the centre of p, q, r lies.
std::vector<std::uint32_t> covering(const io::TriangleMesh& mesh, const View& view, std::uint32_t parent,
                                    const std::vector<std::uint32_t>& others, const std::array<Flat, 3>& part) {
  if (others.empty()) return {};
  const Flat centre = CGAL::centroid(part[0], part[1], part[2]);
  std::vector<std::uint32_t> found{parent};
  for (const std::uint32_t other : others) {
    const Exact::Triangle_3 t = exact(mesh, other);
    const Exact::Triangle_2 seen(view.flat(t[0]), view.flat(t[1]), view.flat(t[2]));
    if (seen.has_on_bounded_side(centre)) found.push_back(other);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

void cut(const io::TriangleMesh& mesh, std::uint32_t t, const Marks3& marks, Vertices& vertices, Arrangement& out) {
  const Exact::Triangle_3 whole = exact(mesh, t);
  const View view(whole);
  Constrained parts;
  for (int c = 0; c < 3; ++c) parts.insert_constraint(view.flat(whole[c]), view.flat(whole[c + 1]));
  for (const Point& p : marks.points) parts.insert(view.flat(p));
  for (const auto& [p, q] : marks.segments) parts.insert_constraint(view.flat(p), view.flat(q));
  std::size_t count = 0;
  for (const auto& face : parts.finite_face_handles()) {
    const std::array<Flat, 3> part{face->vertex(0)->point(), face->vertex(1)->point(), face->vertex(2)->point()};
    Corners corners{};
    for (std::size_t c = 0; c < 3; ++c) corners[c] = vertices.of(view.lifted(part[c]));
    if (view.reversed()) std::swap(corners[1], corners[2]);
    out.triangles.push_back(corners);
    out.parent.push_back(t);
    out.covering.push_back(covering(mesh, view, t, marks.coplanar, part));
    ++count;
  }
  out.cut += count > 1;
}

}  // namespace

Arrangement arrange(const io::TriangleMesh& mesh) {
  Arrangement out;
  const auto pairs = self_intersections(mesh, most_pairs);
  out.crossings = pairs.size();
  out.complete = pairs.size() < most_pairs;
  if (!out.complete) return out;
  std::map<std::uint32_t, Marks3> marks;
  for (const auto& [a, b] : pairs) mark(marks, a, b, mesh);
  Vertices vertices(out.positions_m);
  // Only what is cut needs exact numbers; all else is told apart by its place as it is, which is exact, too.
  const std::vector<std::uint32_t> same = welded(mesh.positions_m);
  std::vector<std::uint32_t> number(mesh.positions_m.size(), nobody);
  for (const auto& [t, own] : marks)
    for (const std::uint32_t v : mesh.triangles[t])
      if (number[same[v]] == nobody) number[same[v]] = vertices.of(exact(mesh.positions_m[v]));
  for (const auto& [t, own] : marks) cut(mesh, t, own, vertices, out);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (marks.contains(t)) continue;
    Corners corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = same[mesh.triangles[t][c]];
      if (number[v] == nobody) {
        number[v] = static_cast<std::uint32_t>(out.positions_m.size());
        out.positions_m.push_back(mesh.positions_m[v]);
      }
      corners[c] = number[v];
    }
    out.triangles.push_back(corners);
    out.parent.push_back(t);
    out.covering.emplace_back();
  }
  return out;
}

}  // namespace gonio::mesh
