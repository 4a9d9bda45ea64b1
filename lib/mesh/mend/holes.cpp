// See holes.h.
#include "mesh/mend/holes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/mend/edges.h"

namespace gonio::mesh {
namespace {

constexpr double same_fold = 1e-9;

// Of a triangulation: cosine of its sharpest fold, and its area.
struct Cost {
  double fold = 1, area = 0;
  bool operator<(const Cost& o) const {
    return fold > o.fold + same_fold || (fold >= o.fold - same_fold && area < o.area);
  }
};

Vec3 doubled_normal(const io::TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Vec3 p = mesh.positions_m[a];
  return cross(mesh.positions_m[b] - p, mesh.positions_m[c] - p);
}
double cosine(Vec3 a, Vec3 b) {
  const double length = norm(a) * norm(b);
  return length > 0 ? dot(a, b) / length : -1;  // a triangle without area is the last choice
}

class Closing {
 public:
  Closing(const io::TriangleMesh& mesh, const std::vector<std::uint32_t>& loop)
      : mesh_(mesh), loop_(loop), n_(loop.size()), cost_(n_ * n_), middle_(n_ * n_, 0), outside_(n_) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> at;  // edges of the rim as the surface passes them
    for (std::size_t i = 0; i < n_; ++i) at[{loop[(i + 1) % n_], loop[i]}] = i;
    for (const Corners& t : mesh.triangles)
      for (std::size_t c = 0; c < 3; ++c)
        if (const auto found = at.find({t[c], t[(c + 1) % 3]}); found != at.end())
          outside_[found->second] = doubled_normal(mesh, t[0], t[1], t[2]);
  }
  std::vector<Corners> best() {
    for (std::size_t span = 2; span < n_; ++span)
      for (std::size_t i = 0; i + span < n_; ++i) settle(i, i + span);
    std::vector<Corners> triangles;
    collect(0, n_ - 1, triangles);
    return triangles;
  }

 private:
  // Normal of what is on the far side of the chord i, j, as it is known by now.
  Vec3 beyond(std::size_t i, std::size_t j) const {
    return j == i + 1 ? outside_[i] : doubled_normal(mesh_, loop_[i], loop_[middle_[i * n_ + j]], loop_[j]);
  }
  void settle(std::size_t i, std::size_t j) {
    Cost& best = cost_[i * n_ + j];
    best = {-2, 0};
    for (std::size_t m = i + 1; m < j; ++m) {
      const Vec3 normal = doubled_normal(mesh_, loop_[i], loop_[m], loop_[j]);
      const Cost &left = cost_[i * n_ + m], &right = cost_[m * n_ + j];
      Cost cost{std::min({left.fold, right.fold, cosine(normal, beyond(i, m)), cosine(normal, beyond(m, j))}),
                left.area + right.area + norm(normal)};
      if (i == 0 && j == n_ - 1) cost.fold = std::min(cost.fold, cosine(normal, outside_[n_ - 1]));
      if (best.fold < -1.5 || cost < best) best = cost, middle_[i * n_ + j] = m;
    }
  }
  void collect(std::size_t i, std::size_t j, std::vector<Corners>& triangles) const {
    if (j < i + 2) return;
    const std::size_t m = middle_[i * n_ + j];
    triangles.push_back({loop_[i], loop_[m], loop_[j]});
    collect(i, m, triangles);
    collect(m, j, triangles);
  }

  const io::TriangleMesh& mesh_;
  const std::vector<std::uint32_t>& loop_;
  std::size_t n_;
  std::vector<Cost> cost_;  // of what closes loop_[i .. j]
  std::vector<std::size_t> middle_;
  std::vector<Vec3> outside_;  // normals behind the rim's edges
};

}  // namespace

std::vector<HoleRim> rims_of(const io::TriangleMesh& mesh, const std::vector<std::uint32_t>& piece) {
  // Against the sense of the triangle that is there.
  std::map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> next;  // of a vertex: the next one, and the triangle
  for_each_edge(edges_of(mesh.triangles), [&](std::span<const MeshEdge> edge) {
    if (edge.size() != 1) return;
    const std::uint32_t from = edge[0].forward ? edge[0].low : edge[0].high;
    next[edge[0].low + edge[0].high - from] = {from, edge[0].face};
  });
  std::vector<HoleRim> rims;
  while (!next.empty()) {
    HoleRim rim;
    rim.piece = piece[next.begin()->second.second];
    for (auto at = next.begin(); at != next.end();) {
      rim.loop.push_back(at->first);
      const std::uint32_t to = at->second.first;
      next.erase(at);
      at = next.find(to);
    }
    Vec3 low = mesh.positions_m[rim.loop[0]], high = low;
    for (const std::uint32_t v : rim.loop) {
      const Vec3 p = mesh.positions_m[v];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    rim.diagonal_m = norm(high - low);
    rims.push_back(std::move(rim));
  }
  return rims;
}

std::vector<Corners> closing_triangles(const io::TriangleMesh& mesh, const std::vector<std::uint32_t>& loop) {
  return Closing(mesh, loop).best();
}

}  // namespace gonio::mesh
