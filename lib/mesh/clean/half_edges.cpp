// Decimation and subdivision on half-edges (OpenMesh). A collapse moves no vertex that stays, so what stays keeps its
// normal, its texture coordinates and its properties, and every triangle that stays keeps its label.
//
// The collapse with the least quadric error goes first (Garland & Heckbert 1997: sum over the planes of the triangles
// that went into both vertices, weighted by area, of the squared distance). It is allowed where the link condition
// holds (Dey et al. 1999: the result is manifold and of the same topology), no triangle turns by more than 60 degrees
// and none becomes a sliver. Whether it is allowed is asked when its turn comes, once, and not for every collapse
// beside it: OpenMesh's own decimater asks always, and takes eight times as long.
#ifndef NDEBUG
#define NDEBUG  // OpenMesh asserts in every step from a half-edge to the next
#endif
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/Sqrt3T.hh>
#include <algorithm>
#include <queue>

#include "base/error.h"
#include "mesh/clean.h"
#include "mesh/mesh.h"

namespace gonio::mesh {
namespace {

constexpr double least_cosine = 0.5;  // of the angle by which a triangle may turn
constexpr double normals_count = 0.5;
constexpr double least_facing = 0.2;        // cosine between a triangle and the normals at its corners
constexpr double folded_cosine = -0.3;      // between neighbours
constexpr double least_compactness = 0.05;  // 4 sqrt(3) area / sum of squared sides: 1 where equilateral

using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;

HalfEdges half_edges_of(const io::TriangleMesh& mesh) {
  HalfEdges built;
  built.reserve(mesh.positions_m.size(), 3 * mesh.triangles.size() / 2 + 1, mesh.triangles.size());
  for (const Vec3 p : mesh.positions_m) built.add_vertex({p.x, p.y, p.z});
  const auto vertex = [](std::uint32_t v) { return HalfEdges::VertexHandle(static_cast<int>(v)); };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const bool proper = a != b && b != c && c != a && std::max({a, b, c}) < mesh.positions_m.size();
    if (!proper || !built.add_face(vertex(a), vertex(b), vertex(c)).is_valid())
      throw Error(Exit::data, "mesh",
                  "triangle " + std::to_string(t) + " meets its neighbours in no surface: an edge or a corner there " +
                      "belongs to more than one sheet",
                  "give a 2-manifold mesh");
  }
  return built;
}

// What is left of `mesh`, in the order that it had.
void keep_rest(const HalfEdges& rest, io::TriangleMesh& mesh) {
  std::vector<std::uint32_t> place(mesh.positions_m.size(), 0);
  std::vector<std::uint32_t> kept;
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    const HalfEdges::VertexHandle vertex(static_cast<int>(v));
    if (rest.status(vertex).deleted() || rest.is_isolated(vertex)) continue;
    place[v] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(v);
  }
  const auto thin = [&](auto& values) {
    if (values.empty()) return;
    for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
    values.resize(kept.size());
    values.shrink_to_fit();
  };
  thin(mesh.positions_m);
  thin(mesh.normals);
  thin(mesh.texture);
  for (auto& values : mesh.properties) thin(values);
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const HalfEdges::FaceHandle face(static_cast<int>(t));
    if (rest.status(face).deleted()) continue;
    std::size_t corner = 0;
    for (const auto& v : rest.fv_range(face))
      mesh.triangles[count][corner++] = place[static_cast<std::size_t>(v.idx())];
    if (!mesh.labels.empty()) mesh.labels[count] = mesh.labels[t];
    ++count;
  }
  mesh.triangles.resize(count);
  mesh.triangles.shrink_to_fit();
  if (!mesh.labels.empty()) mesh.labels.resize(count);
}

Vec3 point_of(const HalfEdges& mesh, HalfEdges::VertexHandle v) {
  const auto& p = mesh.point(v);
  return {p[0], p[1], p[2]};
}

// x'Ax + 2 b'x + c: the weighted sum of squared distances to planes.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, c = 0;
  Vec3 b{};
  void add_plane(Vec3 unit, Vec3 through, double weight) {
    const double d = -dot(unit, through);
    xx += weight * unit.x * unit.x;
    xy += weight * unit.x * unit.y;
    xz += weight * unit.x * unit.z;
    yy += weight * unit.y * unit.y;
    yz += weight * unit.y * unit.z;
    zz += weight * unit.z * unit.z;
    b += unit * (weight * d);
    c += weight * d * d;
  }
  void operator+=(const Quadric& o) {
    xx += o.xx;
    xy += o.xy;
    xz += o.xz;
    yy += o.yy;
    yz += o.yz;
    zz += o.zz;
    b += o.b;
    c += o.c;
  }
  double at(Vec3 p) const {
    const Vec3 a{xx * p.x + xy * p.y + xz * p.z, xy * p.x + yy * p.y + yz * p.z, xz * p.x + yz * p.y + zz * p.z};
    return dot(p, a) + 2 * dot(b, p) + c;
  }
  double weight() const { return xx + yy + zz; }
};

// Sum over triangles of area |gradient p + offset - n|^2, `gradient` and `offset` being a triangle's normals as a
// linear function. What does not depend on n is in a Quadric.
struct NormalQuadric {
  std::array<Vec3, 3> gradients{};
  Vec3 offsets{};
  double weight = 0;
  void operator+=(const NormalQuadric& o) {
    for (std::size_t k = 0; k < 3; ++k) gradients[k] += o.gradients[k];
    offsets += o.offsets;
    weight += o.weight;
  }
  double with(Vec3 p, Vec3 n) const {
    const Vec3 said = Vec3{dot(gradients[0], p), dot(gradients[1], p), dot(gradients[2], p)} + offsets;
    return weight * dot(n, n) - 2 * dot(n, said);
  }
};

class Collapses {
 public:
  // `normals`: one a vertex, or none.
  Collapses(HalfEdges& mesh, const std::vector<Vec3>& normals)
      : mesh_(mesh), normals_(normals), quadrics_(mesh.n_vertices()), stamps_(mesh.n_vertices(), 0) {
    if (mesh.n_vertices() > 0) origin_ = point_of(mesh, HalfEdges::VertexHandle(0));
    if (!normals.empty()) {
      of_normals_.resize(mesh.n_vertices());
      double sum = 0;
      for (const auto& e : mesh.edges()) sum += mesh.calc_edge_length(e);
      normal_length_ = normals_count * sum / static_cast<double>(std::max<std::size_t>(1, mesh.n_edges()));
    }
    for (const auto& f : mesh.faces()) add_face(f);
    for (const auto& h : mesh.halfedges())
      if (mesh.is_boundary(h)) add_border(h);
    std::vector<Waiting> all;
    all.reserve(mesh.n_vertices());
    queued_.assign(mesh.n_vertices(), nothing);
    for (const auto& v : mesh.vertices()) {
      if (mesh.is_isolated(v)) continue;
      const auto i = static_cast<std::uint32_t>(v.idx());
      all.push_back({queued_[i] = cheapest(v), i, 0});
    }
    queue_ = std::priority_queue<Waiting>({}, std::move(all));
  }

  std::size_t down_to(std::size_t faces) {
    std::size_t left = mesh_.n_faces();
    while (left > faces && !queue_.empty()) {
      const Waiting next = queue_.top();
      queue_.pop();
      if (next.stamp != stamps_[next.vertex]) continue;
      queued_[next.vertex] = nothing;
      const HalfEdges::VertexHandle v(static_cast<int>(next.vertex));
      const auto [cost, halfedge] = best_allowed(v);
      if (!halfedge.is_valid()) continue;  // comes back when a new neighbour is cheap
      if (cost > next.cost) {
        push(next.vertex, cost);
        continue;
      }
      left -= mesh_.is_boundary(mesh_.edge_handle(halfedge)) ? 1 : 2;
      collapse(halfedge);
    }
    return left;
  }

 private:
  struct Waiting {
    double cost;
    std::uint32_t vertex, stamp;
    bool operator<(const Waiting& o) const { return cost != o.cost ? cost > o.cost : vertex > o.vertex; }
  };
  Vec3 at(HalfEdges::VertexHandle v) const { return point_of(mesh_, v) - origin_; }
  Quadric& quadric(HalfEdges::VertexHandle v) { return quadrics_[static_cast<std::size_t>(v.idx())]; }

  void add_face(HalfEdges::FaceHandle f) {
    const auto h = mesh_.halfedge_handle(f);
    const auto a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
    const auto c = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h));
    const Vec3 n = cross(at(b) - at(a), at(c) - at(a));
    const double doubled = norm(n);
    if (!(doubled > 0)) return;
    for (const auto v : {a, b, c}) quadric(v).add_plane(n / doubled, at(a), doubled / 2);
    if (!normals_.empty()) add_normals({a, b, c}, n / doubled, doubled / 2);
  }
  // s(p) = s_a + (s_b - s_a) beta(p) + (s_c - s_a) gamma(p), barycentric functions of the triangle's plane.
  void add_normals(std::array<HalfEdges::VertexHandle, 3> corners, Vec3 unit, double area) {
    const Vec3 pa = at(corners[0]), ab = at(corners[1]) - pa, ac = at(corners[2]) - pa;
    const Vec3 beta = cross(ac, unit) / (2 * area), gamma = cross(unit, ab) / (2 * area);
    const Vec3 na = normal_of(corners[0]), nb = normal_of(corners[1]) - na, nc = normal_of(corners[2]) - na;
    const double weight = area * normal_length_ * normal_length_;
    Quadric alone;
    NormalQuadric with_normal;
    for (std::size_t k = 0; k < 3; ++k) {
      const int i = static_cast<int>(k);
      const Vec3 gradient = beta * nb[i] + gamma * nc[i];
      const double length = norm(gradient), offset = na[i] - dot(gradient, pa);
      // (gradient p + offset)^2 is a plane's squared distance times the gradient's squared length.
      if (length > 0)
        alone.add_plane(gradient / length, gradient * (-offset / (length * length)), weight * length * length);
      else
        alone.c += weight * offset * offset;
      with_normal.gradients[k] = gradient * weight;
      (i == 0 ? with_normal.offsets.x : i == 1 ? with_normal.offsets.y : with_normal.offsets.z) = offset * weight;
    }
    with_normal.weight = weight;
    for (const auto v : corners) {
      quadric(v) += alone;
      of_normals_[static_cast<std::size_t>(v.idx())] += with_normal;
    }
  }
  Vec3 normal_of(HalfEdges::VertexHandle v) const { return normals_[static_cast<std::size_t>(v.idx())]; }
  // A plane through a border edge, upright on its triangle, holds the border.
  void add_border(HalfEdges::HalfedgeHandle h) {
    const auto a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
    const auto inner = mesh_.opposite_halfedge_handle(h);
    const auto c = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(inner));
    const Vec3 along = at(b) - at(a), upright = cross(along, cross(along, at(c) - at(a)));
    if (!(norm(upright) > 0)) return;
    for (const auto v : {a, b}) quadric(v).add_plane(normalized(upright), at(a), dot(along, along));
  }
  // Where planes leave it open, short edges go first.
  double cost(HalfEdges::VertexHandle from, HalfEdges::VertexHandle to) {
    const Vec3 p = at(to), edge = p - at(from);
    double error = quadric(from).at(p) + quadric(to).at(p);
    if (!normals_.empty()) {
      const Vec3 n = normal_of(to);
      error += of_normals_[static_cast<std::size_t>(from.idx())].with(p, n) +
               of_normals_[static_cast<std::size_t>(to.idx())].with(p, n);
    }
    return std::max(0.0, error) + 1e-9 * quadric(from).weight() * dot(edge, edge);
  }
  double cheapest(HalfEdges::VertexHandle v) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& to : mesh_.vv_range(v)) least = std::min(least, cost(v, to));
    return least;
  }
  std::pair<double, HalfEdges::HalfedgeHandle> best_allowed(HalfEdges::VertexHandle v) {
    candidates_.clear();
    for (const auto& h : mesh_.voh_range(v)) candidates_.emplace_back(cost(v, mesh_.to_vertex_handle(h)), h);
    std::sort(candidates_.begin(), candidates_.end());
    for (const auto& candidate : candidates_)
      if (allowed(candidate.second)) return candidate;
    return {0, HalfEdges::HalfedgeHandle()};
  }
  bool allowed(HalfEdges::HalfedgeHandle h) const {
    const auto from = mesh_.from_vertex_handle(h);
    if (mesh_.is_boundary(from) && !mesh_.is_boundary(mesh_.edge_handle(h))) return false;
    // What lies beside the edge loses one edge, and needs three.
    for (const auto side : {h, mesh_.opposite_halfedge_handle(h)}) {
      if (mesh_.is_boundary(side)) continue;
      const auto beside = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(side));
      if (mesh_.valence(beside) <= 3 && !mesh_.is_boundary(beside)) return false;
    }
    return keeps_shape(h) && const_cast<HalfEdges&>(mesh_).is_collapse_ok(h);
  }
  static double compactness(Vec3 ab, Vec3 ac, double doubled_area) {
    const Vec3 bc = ac - ab;
    return 2 * std::sqrt(3.0) * doubled_area / (dot(ab, ab) + dot(ac, ac) + dot(bc, bc));
  }
  // None of the triangles that move turns over, or becomes a sliver that was none.
  bool keeps_shape(HalfEdges::HalfedgeHandle h) const {
    const auto from = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    const Vec3 old_place = at(from), new_place = at(to);
    for (const auto& out : mesh_.voh_range(from)) {
      if (mesh_.is_boundary(out)) continue;
      const auto b = mesh_.to_vertex_handle(out), c = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(out));
      if (b == to || c == to) continue;
      const Vec3 pb = at(b), pc = at(c);
      const Vec3 before = cross(pb - old_place, pc - old_place), after = cross(pb - new_place, pc - new_place);
      const double length = norm(before), doubled = norm(after);
      if (!(doubled > 0) || dot(before, after) < least_cosine * length * doubled) return false;
      const double now = compactness(pb - new_place, pc - new_place, doubled);
      if (now < least_compactness && now < compactness(pb - old_place, pc - old_place, length)) return false;
      if (folds(mesh_.opposite_halfedge_handle(mesh_.next_halfedge_handle(out)), from, after, before)) return false;
      if (!normals_.empty())
        for (const auto v : {to, b, c})
          if (dot(after, normal_of(v)) < least_facing * doubled && dot(before, normal_of(v)) >= least_facing * length)
            return false;
    }
    return true;
  }
  // Would a triangle with that normal be folded back over the neighbour behind `beyond`, and was it not before?
  bool folds(HalfEdges::HalfedgeHandle beyond, HalfEdges::VertexHandle going, Vec3 after, Vec3 before) const {
    if (mesh_.is_boundary(beyond)) return false;
    const auto apex = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(beyond));
    if (apex == going) return false;
    const Vec3 a = at(mesh_.from_vertex_handle(beyond)), b = at(mesh_.to_vertex_handle(beyond));
    const Vec3 n = cross(b - a, at(apex) - a);
    return dot(after, n) < folded_cosine * norm(after) * norm(n) &&
           dot(before, n) >= folded_cosine * norm(before) * norm(n);
  }
  void collapse(HalfEdges::HalfedgeHandle h) {
    const auto from = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    quadric(to) += quadric(from);
    if (!normals_.empty())
      of_normals_[static_cast<std::size_t>(to.idx())] += of_normals_[static_cast<std::size_t>(from.idx())];
    ++stamps_[static_cast<std::size_t>(from.idx())];
    mesh_.collapse(h);
    // What waits, waits with no more than it costs: errors only grow, and the edges to `to` alone are new.
    push(static_cast<std::uint32_t>(to.idx()), cheapest(to));
    for (const auto& beside : mesh_.vv_range(to)) push(static_cast<std::uint32_t>(beside.idx()), cost(beside, to));
  }
  void push(std::uint32_t v, double cost) {
    if (cost >= queued_[v]) return;
    queued_[v] = cost;
    queue_.push({cost, v, ++stamps_[v]});
  }

  HalfEdges& mesh_;
  const std::vector<Vec3>& normals_;
  Vec3 origin_{};
  double normal_length_ = 0;
  std::vector<NormalQuadric> of_normals_;
  std::vector<Quadric> quadrics_;
  static constexpr double nothing = std::numeric_limits<double>::infinity();
  std::vector<double> queued_;  // what each vertex waits with
  std::vector<std::uint32_t> stamps_;
  std::priority_queue<Waiting> queue_;
  std::vector<std::pair<double, HalfEdges::HalfedgeHandle>> candidates_;
};

}  // namespace

std::size_t decimate(io::TriangleMesh& mesh, std::size_t faces) {
  if (mesh.triangles.size() <= faces) return mesh.triangles.size();
  HalfEdges built = half_edges_of(mesh);
  built.request_vertex_status();
  built.request_edge_status();
  built.request_halfedge_status();
  built.request_face_status();
  Collapses(built, mesh.normals).down_to(faces);
  keep_rest(built, mesh);
  return mesh.triangles.size();
}

void subdivide_sqrt3(io::TriangleMesh& mesh) {
  HalfEdges built = half_edges_of(mesh);
  OpenMesh::Subdivider::Uniform::Sqrt3T<HalfEdges, double> subdivider;
  subdivider.attach(built);
  subdivider(1);
  subdivider.detach();
  const bool with_normals = !mesh.normals.empty();
  mesh = {};
  mesh.positions_m.reserve(built.n_vertices());
  for (const auto& v : built.vertices()) {
    const auto& p = built.point(v);
    mesh.positions_m.push_back({p[0], p[1], p[2]});
  }
  mesh.triangles.reserve(built.n_faces());
  for (const auto& f : built.faces()) {
    std::array<std::uint32_t, 3> t{};
    std::size_t corner = 0;
    for (const auto& v : built.fv_range(f)) t[corner++] = static_cast<std::uint32_t>(v.idx());
    mesh.triangles.push_back(t);
  }
  if (with_normals) mesh.normals = averaged_normals(mesh.positions_m, mesh.triangles);
}

}  // namespace gonio::mesh
