// Pairs that meet are found by self_intersections(). Each triangle of them is triangulated anew, in its plane seen
// along the axis that it is most square to, with its edges and its intersections as constraints (CGAL). Points are the
// same where their exact coordinates are: those on an edge come out alike from the triangles on its both sides.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("rounding-math")  // CGAL's interval arithmetic turns the processor's rounding
#endif
#define CGAL_NO_CDT_2_WARNING 1  // constraints that cross are few here
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
constexpr int most_attempts = 64;

Point exact(Vec3 p) {
  return {p.x, p.y, p.z};
}
Exact::Triangle_3 exact(const io::TriangleMesh& mesh, std::uint32_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {exact(mesh.positions_m[a]), exact(mesh.positions_m[b]), exact(mesh.positions_m[c])};
}

// What others leave on one triangle.
struct TriangleMarks {
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

Vec3 rounded(const Point& p) {
  return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
}

class Vertices {
 public:
  Vertices(std::vector<Vec3>& positions, std::vector<Point>& points) : positions_(positions), points_(points) {}
  std::uint32_t of(const Point& p) {
    const auto [at, fresh] = numbers_.try_emplace(p, static_cast<std::uint32_t>(positions_.size()));
    if (fresh) positions_.push_back(rounded(p)), points_.push_back(p);
    return at->second;
  }

 private:
  std::map<Point, std::uint32_t> numbers_;
  std::vector<Vec3>& positions_;
  std::vector<Point>& points_;
};

void mark(std::map<std::uint32_t, TriangleMarks>& marks, std::uint32_t a, std::uint32_t b,
          const io::TriangleMesh& mesh) {
  const auto common = CGAL::intersection(exact(mesh, a), exact(mesh, b));
  if (!common) return;
  std::vector<Point> outline;
  if (const Point* p = boost::get<Point>(&*common)) outline = {*p};
  if (const Exact::Segment_3* s = boost::get<Exact::Segment_3>(&*common)) outline = {s->source(), s->target()};
  if (const Exact::Triangle_3* t = boost::get<Exact::Triangle_3>(&*common)) outline = {(*t)[0], (*t)[1], (*t)[2]};
  if (const std::vector<Point>* p = boost::get<std::vector<Point>>(&*common)) outline = *p;
  for (const std::uint32_t mine : {a, b}) {
    TriangleMarks& own = marks[mine];
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

void cut(const io::TriangleMesh& mesh, std::uint32_t t, const TriangleMarks& marks, Vertices& vertices,
         Arrangement& out) {
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

struct Box {
  Vec3 low{}, high{};
};
// A ray as a segment to a place beyond the mesh, and the box that holds it.
struct Ray {
  Point from, to;
  Box box;
};
Box box_of(const io::TriangleMesh& mesh) {
  Box box{mesh.positions_m[0], mesh.positions_m[0]};
  for (const Vec3 p : mesh.positions_m) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

// Nearly along x, so that its box is small; turned by odd angles, further ones where it met an edge.
Ray ray_from(const Box& mesh, const Point& from, int attempt) {
  const double size = norm(mesh.high - mesh.low);
  const Vec3 start = rounded(from);
  const double u = std::fmod(0.0061803 * (attempt + 1), 0.01) - 0.004,
               v = std::fmod(0.0041421 * (attempt + 1), 0.01) - 0.003;
  const Vec3 end{mesh.high.x + size, start.y + u * size, start.z + v * size};
  const Vec3 margin = Vec3{1, 1, 1} * (1e-6 * size);
  return {from,
          exact(end),
          {Vec3{start.x, std::min(start.y, end.y), std::min(start.z, end.z)} - margin,
           Vec3{end.x, std::max(start.y, end.y), std::max(start.z, end.z)} + margin}};
}

bool apart(const Ray& ray, Vec3 a, Vec3 b, Vec3 c) {
  const auto beside = [](double low, double high, double p, double q, double r) {
    return (p < low && q < low && r < low) || (p > high && q > high && r > high);
  };
  return beside(ray.box.low.x, ray.box.high.x, a.x, b.x, c.x) || beside(ray.box.low.y, ray.box.high.y, a.y, b.y, c.y) ||
         beside(ray.box.low.z, ray.box.high.z, a.z, b.z, c.z);
}

// 1 where the ray leaves through the triangle's front, -1 through its back, 0 where it passes it by; `edge` is set
// where it meets the rim or stays in the plane.
int crossing(const Ray& ray, const Exact::Triangle_3& t, bool& edge) {
  const CGAL::Orientation from = CGAL::orientation(t[0], t[1], t[2], ray.from),
                          to = CGAL::orientation(t[0], t[1], t[2], ray.to);
  if (from == to && from != CGAL::COPLANAR) return 0;
  std::array<CGAL::Orientation, 3> sides{};
  for (int c = 0; c < 3; ++c) sides[static_cast<std::size_t>(c)] = CGAL::orientation(ray.from, ray.to, t[c], t[c + 1]);
  const bool left = std::ranges::count(sides, CGAL::POSITIVE) > 0,
             right = std::ranges::count(sides, CGAL::NEGATIVE) > 0;
  if (left && right) return 0;
  if (from == CGAL::COPLANAR || to == CGAL::COPLANAR || std::ranges::count(sides, CGAL::COPLANAR) > 0) {
    edge = true;
    return 0;
  }
  return from == CGAL::NEGATIVE ? 1 : -1;
}

// Triangles by where they are seen along x: cells of a grid, and those that are large.
class SeenAlongX {
 public:
  explicit SeenAlongX(const io::TriangleMesh& mesh) : box_(box_of(mesh)) {
    cells_a_side_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(mesh.triangles.size())) / 2), 1, 512);
    cells_.resize(static_cast<std::size_t>(cells_a_side_) * static_cast<std::size_t>(cells_a_side_));
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3 a = mesh.positions_m[mesh.triangles[t][0]], b = mesh.positions_m[mesh.triangles[t][1]],
                 c = mesh.positions_m[mesh.triangles[t][2]];
      const Cells own = cells({{0, std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})},
                               {0, std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})}});
      if (own.count() > most_cells)
        large_.push_back(t);
      else
        for_each(own, [&](std::vector<std::uint32_t>& cell) { cell.push_back(t); });
    }
  }
  const Box& box() const { return box_; }
  // All that the ray may meet, each once, and others.
  std::vector<std::uint32_t> along(const Ray& ray) {
    std::vector<std::uint32_t> found = large_;
    for_each(cells(ray.box),
             [&](const std::vector<std::uint32_t>& cell) { found.insert(found.end(), cell.begin(), cell.end()); });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  static constexpr int most_cells = 64;
  struct Cells {
    int y0, y1, z0, z1;  // all within
    int count() const { return (y1 - y0 + 1) * (z1 - z0 + 1); }
  };
  int cell(double p, double low, double high) const {
    const double at = high > low ? (p - low) / (high - low) * cells_a_side_ : 0;
    return std::clamp(static_cast<int>(at), 0, cells_a_side_ - 1);
  }
  Cells cells(const Box& b) const {
    return {cell(b.low.y, box_.low.y, box_.high.y), cell(b.high.y, box_.low.y, box_.high.y),
            cell(b.low.z, box_.low.z, box_.high.z), cell(b.high.z, box_.low.z, box_.high.z)};
  }
  template <class Body>
  void for_each(const Cells& some, const Body& body) {
    for (int y = some.y0; y <= some.y1; ++y)
      for (int z = some.z0; z <= some.z1; ++z) body(cells_[static_cast<std::size_t>(y * cells_a_side_ + z)]);
  }

  Box box_;
  int cells_a_side_ = 1;
  std::vector<std::vector<std::uint32_t>> cells_;
  std::vector<std::uint32_t> large_;
};

}  // namespace

struct Arrangement::Exactly {
  explicit Exactly(const io::TriangleMesh& mesh) : seen(mesh) {}
  std::vector<Point> points{};
  SeenAlongX seen;
};

std::array<int, 2> windings(const io::TriangleMesh& mesh, const Arrangement& arrangement, std::uint32_t triangle) {
  const auto& [a, b, c] = arrangement.triangles[triangle];
  const std::vector<Point>& points = arrangement.exactly->points;
  const Point middle = CGAL::centroid(points[a], points[b], points[c]);
  const std::uint32_t parent = arrangement.parent[triangle];
  std::vector<std::uint32_t> on_it = arrangement.covering[triangle];
  if (on_it.empty()) on_it.push_back(parent);
  const Exact::Vector_3 normal = exact(mesh, parent).supporting_plane().orthogonal_vector();
  int senses = 0;
  for (const std::uint32_t t : on_it)
    senses += exact(mesh, t).supporting_plane().orthogonal_vector() * normal > 0 ? 1 : -1;
  for (int attempt = 0;; ++attempt) {
    const Ray ray = ray_from(arrangement.exactly->seen.box(), middle, attempt);
    const Exact::Triangle_3 own = exact(mesh, parent);
    const CGAL::Orientation ahead = CGAL::orientation(own[0], own[1], own[2], ray.to);
    bool edge = ahead == CGAL::COPLANAR;
    int count = 0;
    for (const std::uint32_t t : arrangement.exactly->seen.along(ray)) {
      const auto& [i, j, k] = mesh.triangles[t];
      if (apart(ray, mesh.positions_m[i], mesh.positions_m[j], mesh.positions_m[k])) continue;
      if (std::ranges::binary_search(on_it, t)) continue;
      count += crossing(ray, exact(mesh, t), edge);
    }
    if (edge && attempt < most_attempts) continue;
    return ahead == CGAL::POSITIVE ? std::array{count, count + senses} : std::array{count - senses, count};
  }
}

Arrangement arrange(const io::TriangleMesh& mesh) {
  Arrangement out;
  const auto pairs = self_intersections(mesh, most_pairs);
  out.crossings = pairs.size();
  out.complete = pairs.size() < most_pairs;
  if (!out.complete) return out;
  std::map<std::uint32_t, TriangleMarks> marks;
  for (const auto& [a, b] : pairs) mark(marks, a, b, mesh);
  out.exactly = std::make_shared<Arrangement::Exactly>(mesh);
  Vertices vertices(out.positions_m, out.exactly->points);
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
        out.exactly->points.push_back(exact(mesh.positions_m[v]));
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
