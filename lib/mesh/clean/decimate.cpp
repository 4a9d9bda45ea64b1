// Decimation. A collapse moves no vertex that stays, so what stays keeps its normal, its texture coordinates and its
// properties, and every triangle that stays keeps its label.
//
// The collapse with the least quadric error goes first (Garland & Heckbert 1997: sum over the planes of the triangles
// that went into both vertices, weighted by area, of the squared distance). It is allowed where the link condition
// holds (Dey et al. 1999: the result is manifold and of the same topology), no triangle turns by more than 60 degrees
// and none becomes a sliver. Whether it is allowed is asked when its turn comes, once, and not for every collapse
// beside it.
#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>

#include "base/parallel.h"
#include "mesh/clean.h"
#include "mesh/clean/linked_triangles.h"
#include "mesh/mesh.h"

namespace gonio::mesh {
namespace {

constexpr double least_cosine = 0.5;  // of the angle by which a triangle may turn
constexpr double normals_count = 0.5;
constexpr double least_facing = 0.2;        // cosine between a triangle and the normals at its corners
constexpr double folded_cosine = -0.3;      // between neighbours
constexpr double least_compactness = 0.05;  // 4 sqrt(3) area / sum of squared sides: 1 where equilateral

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

// All that is known of a vertex, in one place: collapses come from all over the mesh.
struct CollapsingVertex {
  Vec3 at{}, normal{};  // from the first vertex; zero where the mesh has no normals
  Quadric planes{};
  NormalQuadric normals{};
  double waits_with = std::numeric_limits<double>::infinity();
  std::uint32_t stamp = 0;
};

class Collapses {
 public:
  using Edge = LinkedTriangles::Edge;

  explicit Collapses(const io::TriangleMesh& mesh)
      : with_normals_(!mesh.normals.empty()),
        links_(mesh.triangles, mesh.positions_m.size()),
        all_(mesh.positions_m.size()) {
    for (std::size_t v = 0; v < all_.size(); ++v) {
      all_[v].at = mesh.positions_m[v] - mesh.positions_m[0];
      if (with_normals_) all_[v].normal = mesh.normals[v];
    }
    if (with_normals_) measure_edges();
    for (std::uint32_t t = 0; t < links_.triangles(); ++t) {
      add_face(t);
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
        if (links_.twin(h) == LinkedTriangles::none) add_border(h);
    }
    parallel_for(
        0, all_.size(),
        [&](std::size_t v) {
          if (!links_.isolated(static_cast<std::uint32_t>(v)))
            all_[v].waits_with = cheapest(static_cast<std::uint32_t>(v));
        },
        4096);
    std::vector<Waiting> waiting;
    waiting.reserve(all_.size());
    for (std::uint32_t v = 0; v < all_.size(); ++v)
      if (!links_.isolated(v)) waiting.push_back({all_[v].waits_with, v, 0});
    queue_ = std::priority_queue<Waiting>({}, std::move(waiting));
  }

  std::size_t down_to(std::size_t faces) {
    std::size_t left = links_.triangles();
    while (left > faces && !queue_.empty()) {
      const Waiting next = queue_.top();
      queue_.pop();
      if (next.stamp != all_[next.vertex].stamp) continue;
      all_[next.vertex].waits_with = nothing;
      const auto [cost, edge] = best_allowed(next.vertex);
      if (!edge.valid()) continue;  // comes back when a new neighbour is cheap
      if (cost > next.cost)
        push(next.vertex, cost);
      else
        left -= collapse(edge);
    }
    return left;
  }
  const LinkedTriangles& rest() const { return links_; }

 private:
  struct Waiting {
    double cost;
    std::uint32_t vertex, stamp;
    bool operator<(const Waiting& o) const { return cost != o.cost ? cost > o.cost : vertex > o.vertex; }
  };
  struct Candidate {
    double cost = 0;
    Edge edge{};
    bool operator<(const Candidate& o) const { return cost != o.cost ? cost < o.cost : edge.to < o.edge.to; }
  };
  static constexpr double nothing = std::numeric_limits<double>::infinity();
  Vec3 at(std::uint32_t v) const { return all_[v].at; }

  void measure_edges() {
    double sum = 0, count = 0;
    for (std::uint32_t h = 0; h < 3 * links_.triangles(); ++h)
      if (links_.twin(h) == LinkedTriangles::none || h < links_.twin(h))
        sum += norm(at(links_.to(h)) - at(links_.from(h))), ++count;
    normal_length_ = normals_count * sum / std::max(1.0, count);
  }
  void add_face(std::uint32_t t) {
    const std::array<std::uint32_t, 3> corners{links_.corner(t, 2), links_.corner(t, 0), links_.corner(t, 1)};
    const Vec3 p = at(corners[0]), n = cross(at(corners[1]) - p, at(corners[2]) - p);
    const double doubled = norm(n);
    if (!(doubled > 0)) return;
    for (const std::uint32_t v : corners) all_[v].planes.add_plane(n / doubled, p, doubled / 2);
    if (with_normals_) add_normals(corners, n / doubled, doubled / 2);
  }
  // s(p) = s_a + (s_b - s_a) beta(p) + (s_c - s_a) gamma(p), barycentric functions of the triangle's plane.
  void add_normals(const std::array<std::uint32_t, 3>& corners, Vec3 unit, double area) {
    const Vec3 pa = at(corners[0]), ab = at(corners[1]) - pa, ac = at(corners[2]) - pa;
    const Vec3 beta = cross(ac, unit) / (2 * area), gamma = cross(unit, ab) / (2 * area);
    const Vec3 na = all_[corners[0]].normal, nb = all_[corners[1]].normal - na, nc = all_[corners[2]].normal - na;
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
    for (const std::uint32_t v : corners) all_[v].planes += alone, all_[v].normals += with_normal;
  }
  // A plane through a border edge, upright on its triangle, holds the border.
  void add_border(std::uint32_t h) {
    const std::uint32_t a = links_.from(h), b = links_.to(h);
    const Vec3 along = at(a) - at(b), upright = cross(along, cross(along, at(links_.apex(h)) - at(b)));
    if (!(norm(upright) > 0)) return;
    for (const std::uint32_t v : {a, b}) all_[v].planes.add_plane(normalized(upright), at(b), dot(along, along));
  }
  // Where planes leave it open, short edges go first.
  double cost(std::uint32_t from, std::uint32_t to) const {
    const CollapsingVertex &going = all_[from], &staying = all_[to];
    const Vec3 p = staying.at, edge = p - going.at;
    double error = going.planes.at(p) + staying.planes.at(p);
    if (with_normals_) error += going.normals.with(p, staying.normal) + staying.normals.with(p, staying.normal);
    return std::max(0.0, error) + 1e-9 * going.planes.weight() * dot(edge, edge);
  }
  double cheapest(std::uint32_t v) const {
    double least = nothing;
    links_.edges_from(v, [&](const Edge& e) { return least = std::min(least, cost(v, e.to)), true; });
    return least;
  }
  Candidate best_allowed(std::uint32_t v) {
    candidates_.clear();
    links_.edges_from(v, [&](const Edge& e) { return candidates_.push_back({cost(v, e.to), e}), true; });
    std::sort(candidates_.begin(), candidates_.end());
    for (const Candidate& candidate : candidates_)
      if (allowed(candidate.edge)) return candidate;
    return {};
  }
  bool allowed(const Edge& edge) const {
    if (links_.at_border(edge.from) && !edge.border()) return false;
    return keeps_shape(edge) && links_.can_collapse(edge);
  }
  static double compactness(Vec3 ab, Vec3 ac, double doubled_area) {
    const Vec3 bc = ac - ab;
    return 2 * std::sqrt(3.0) * doubled_area / (dot(ab, ab) + dot(ac, ac) + dot(bc, bc));
  }
  // None of the triangles that move turns over, or becomes a sliver that was none.
  bool keeps_shape(const Edge& edge) const {
    bool keeps = true;
    links_.around(edge.from, [&](std::uint32_t h) {
      const std::uint32_t b = links_.to(h), c = links_.apex(h);
      keeps = b == edge.to || c == edge.to || keeps_triangle(edge, links_.next(h), b, c);
      return keeps;
    });
    return keeps;
  }
  bool keeps_triangle(const Edge& edge, std::uint32_t behind, std::uint32_t b, std::uint32_t c) const {
    const Vec3 old_place = at(edge.from), new_place = at(edge.to), pb = at(b), pc = at(c);
    const Vec3 before = cross(pb - old_place, pc - old_place), after = cross(pb - new_place, pc - new_place);
    const double length = norm(before), doubled = norm(after);
    if (!(doubled > 0) || dot(before, after) < least_cosine * length * doubled) return false;
    const double now = compactness(pb - new_place, pc - new_place, doubled);
    if (now < least_compactness && now < compactness(pb - old_place, pc - old_place, length)) return false;
    if (folds(links_.twin(behind), edge.from, after, before)) return false;
    if (!with_normals_) return true;
    for (const std::uint32_t v : {edge.to, b, c}) {
      const Vec3 n = all_[v].normal;
      if (dot(after, n) < least_facing * doubled && dot(before, n) >= least_facing * length) return false;
    }
    return true;
  }
  // Would a triangle with that normal be folded back over the neighbour behind `beyond`, and was it not before?
  bool folds(std::uint32_t beyond, std::uint32_t going, Vec3 after, Vec3 before) const {
    if (beyond == LinkedTriangles::none) return false;
    const std::uint32_t apex = links_.apex(beyond);
    if (apex == going) return false;
    const Vec3 a = at(links_.from(beyond)), n = cross(at(links_.to(beyond)) - a, at(apex) - a);
    return dot(after, n) < folded_cosine * norm(after) * norm(n) &&
           dot(before, n) >= folded_cosine * norm(before) * norm(n);
  }
  std::size_t collapse(const Edge& edge) {
    CollapsingVertex &going = all_[edge.from], &staying = all_[edge.to];
    staying.planes += going.planes;
    if (with_normals_) staying.normals += going.normals;
    ++going.stamp;
    const std::size_t less = links_.collapse(edge);
    // What waits, waits with no more than it costs: errors only grow, and the edges to `to` alone are new.
    push(edge.to, cheapest(edge.to));
    links_.edges_from(edge.to, [&](const Edge& e) { return push(e.to, cost(e.to, edge.to)), true; });
    return less;
  }
  void push(std::uint32_t v, double cost) {
    if (cost >= all_[v].waits_with) return;
    all_[v].waits_with = cost;
    queue_.push({cost, v, ++all_[v].stamp});
  }

  bool with_normals_;
  LinkedTriangles links_;
  std::vector<CollapsingVertex> all_;
  double normal_length_ = 0;
  std::priority_queue<Waiting> queue_;
  std::vector<Candidate> candidates_;
};

// What is left of `mesh`, in the order that it had; returns the vertices that stay.
std::vector<std::uint32_t> keep_rest(const LinkedTriangles& rest, io::TriangleMesh& mesh) {
  std::vector<std::uint32_t> place(mesh.positions_m.size(), 0), kept;
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    if (rest.isolated(v)) continue;
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
  for (std::uint32_t t = 0; t < rest.triangles(); ++t) {
    if (rest.gone(t)) continue;
    for (std::size_t c = 0; c < 3; ++c) mesh.triangles[count][c] = place[rest.corner(t, c)];
    if (!mesh.labels.empty()) mesh.labels[count] = mesh.labels[t];
    ++count;
  }
  mesh.triangles.resize(count);
  mesh.triangles.shrink_to_fit();
  if (!mesh.labels.empty()) mesh.labels.resize(count);
  return kept;
}

}  // namespace

std::size_t decimate(io::TriangleMesh& mesh, std::size_t faces, std::vector<std::uint32_t>* kept) {
  if (mesh.triangles.size() <= faces) {
    if (kept != nullptr) {
      kept->resize(mesh.positions_m.size());
      std::iota(kept->begin(), kept->end(), 0U);
    }
    return mesh.triangles.size();
  }
  Collapses collapses(mesh);
  collapses.down_to(faces);
  std::vector<std::uint32_t> stay = keep_rest(collapses.rest(), mesh);
  if (kept != nullptr) *kept = std::move(stay);
  return mesh.triangles.size();
}

}  // namespace gonio::mesh
