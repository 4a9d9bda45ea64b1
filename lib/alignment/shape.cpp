// See shape.h.
#include "alignment/shape.h"

#include <algorithm>
#include <map>

#include "mesh/topology.h"

namespace gonio::alignment {
namespace {

struct Side {  // one triangle's side, by its vertices in ascending order
  std::uint32_t low, high, use;
  bool operator<(const Side& o) const {
    return low != o.low ? low < o.low : high != o.high ? high < o.high : use < o.use;
  }
};

}  // namespace

Shape::Shape(std::vector<Vec3> positions_m, std::span<const std::array<std::uint32_t, 3>> triangles)
    : positions_(std::move(positions_m)) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  const std::vector<std::uint32_t> same = mesh::welded(positions_);
  bool first = true;
  for (const auto& given : triangles) {
    const std::array<std::uint32_t, 3> t{same[given[0]], same[given[1]], same[given[2]]};
    const Vec3 a = positions_[t[0]], b = positions_[t[1]], c = positions_[t[2]];
    const Vec3 n = cross(b - a, c - a);
    if (!(norm(n) > 0)) continue;
    const auto index = static_cast<std::uint32_t>(corners_.size());
    corners_.push_back(t);
    nx_.push_back(n.x), ny_.push_back(n.y), nz_.push_back(n.z), offset_.push_back(dot(n, a));
    volume_ += dot(a, cross(b, c)) / 6;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i], to = t[(i + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), 2 * index + (from > to ? 1U : 0U)});
      const Vec3 p = positions_[t[i]];
      if (first) lower_ = upper_ = p, first = false;
      lower_ = {std::min(lower_.x, p.x), std::min(lower_.y, p.y), std::min(lower_.z, p.z)};
      upper_ = {std::max(upper_.x, p.x), std::max(upper_.y, p.y), std::max(upper_.z, p.z)};
    }
  }
  for (const auto& t : corners_)
    for (const std::uint32_t v : t) radius_ = std::max(radius_, norm(positions_[v] - centre_m()));
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    for (end = i; end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high;) ++end;
    if (end - i == 1) ++open_edges_;
    if (end - i <= 2) {
      edges_.push_back({sides[i].low, sides[i].high, sides[i].use, end - i == 2 ? sides[i + 1].use : none});
    } else {
      std::vector<std::uint32_t> crowd{sides[i].low, sides[i].high};
      for (std::size_t k = i; k < end; ++k) crowd.push_back(sides[k].use);
      crowds_.push_back(std::move(crowd));
    }
  }
}

Shape Shape::rough(int cells) const {
  // Vertex clustering (Rossignac & Borrel 1993): any triangles will do, and what falls together vanishes.
  const double size = radius_ / cells;
  std::map<std::array<int, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> to(positions_.size(), ~0U);
  std::vector<Vec3> sums;
  std::vector<double> counts;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto place = [&](std::uint32_t v) {
    if (to[v] != ~0U) return to[v];
    const Vec3 d = (positions_[v] - lower_) / size;
    const auto [at, fresh] = places.try_emplace({static_cast<int>(d.x), static_cast<int>(d.y), static_cast<int>(d.z)},
                                                static_cast<std::uint32_t>(sums.size()));
    if (fresh) sums.push_back({}), counts.push_back(0);
    sums[at->second] += positions_[v], counts[at->second] += 1;
    return to[v] = at->second;
  };
  for (const auto& t : corners_) {
    const std::array<std::uint32_t, 3> c{place(t[0]), place(t[1]), place(t[2])};
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) triangles.push_back(c);
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = sums[i] / counts[i];
  Shape out(std::move(sums), triangles);
  // Its middle is the fine one's: about it bodies are scaled and turned.
  out.lower_ = lower_, out.upper_ = upper_, out.radius_ = radius_;
  return out;
}

void Shape::rim_edges(Vec3 eye_m, bool mirrored, std::vector<std::uint8_t>& faces, std::vector<RimEdge>& edges) const {
  const std::size_t count = nx_.size();
  faces.resize(count);
  const std::uint8_t flip = mirrored ? 1 : 0;
  for (std::size_t t = 0; t < count; ++t) {
    const double along = nx_[t] * eye_m.x + ny_[t] * eye_m.y + nz_[t] * eye_m.z;
    faces[t] = static_cast<std::uint8_t>(along > offset_[t]) ^ flip;
  }
  // A triangle that faces the eye and runs a -> b lies to the left; either reversed, to the right.
  const auto side = [&](std::uint32_t use) { return faces[use >> 1U] ^ (use & 1U) ? 1 : -1; };
  edges.clear();
  const auto add = [&](std::uint32_t a, std::uint32_t b, int jump) {
    if (jump > 0) edges.push_back({a, b, jump});
    if (jump < 0) edges.push_back({b, a, -jump});
  };
  for (const Edge& e : edges_) {
    const int jump = side(e.first) + (e.second == none ? 0 : side(e.second));
    if (jump != 0) add(e.a, e.b, jump);
  }
  for (const auto& crowd : crowds_) {
    int jump = 0;
    for (std::size_t k = 2; k < crowd.size(); ++k) jump += side(crowd[k]);
    add(crowd[0], crowd[1], jump);
  }
}

}  // namespace gonio::alignment
