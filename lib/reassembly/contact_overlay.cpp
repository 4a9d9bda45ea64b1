// Inequalities at the vertices of the overlay of two meshes: see contact_overlay.h.
#include "reassembly/contact_overlay.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "reassembly/contact_grid.h"

namespace gonio::reassembly::contact {
namespace {

// Twice the signed area of (a, b, p) in the plane: the same number, but for its sign, whichever way the edge is asked.
double side_of(Vec3 p, Vec3 a, Vec3 b) {
  const bool turned = b.x < a.x || (b.x == a.x && b.y < a.y);
  if (turned) std::swap(a, b);
  const double s = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  return turned ? -s : s;
}

using Corners = std::array<Vec3, 3>;
Corners corners_of(const Layered& mesh, std::uint32_t face) {
  const auto& [a, b, c] = mesh.faces[face];
  return {mesh.at[a], mesh.at[b], mesh.at[c]};
}

// Weights of the corners of a triangle at a point in the plane; nothing outside of it. A point on an edge is inside.
std::optional<std::array<double, 3>> weights_at(Vec3 p, const Corners& t) {
  const double a = side_of(p, t[1], t[2]), b = side_of(p, t[2], t[0]), c = side_of(p, t[0], t[1]), sum = a + b + c;
  if (sum == 0 || !((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0))) return {};
  return std::array{a / sum, b / sum, c / sum};
}

// Likewise, but a point on an edge belongs to one of the two faces only: crossings of a line are counted once.
bool crossed_by_line(Vec3 p, const Corners& t) {
  const auto left = [&](Vec3 a, Vec3 b) {
    const bool turned = b.x < a.x || (b.x == a.x && b.y < a.y);
    const double s = side_of(p, a, b);
    return s > 0 || (s == 0 && !turned);
  };
  const bool one = left(t[0], t[1]);
  return one == left(t[1], t[2]) && one == left(t[2], t[0]);
}

double depth_at(const Corners& t, const std::array<double, 3>& w) {
  return w[0] * t[0].z + w[1] * t[1].z + w[2] * t[2].z;
}

bool faces_down(const Corners& t) {
  return (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x) > 0;
}

// Of the plane that two directions span; level where it stands upright.
Vec2 slope_of(Vec3 a, Vec3 b) {
  const Vec3 n = cross(a, b);
  return n.z != 0 ? Vec2{-n.x / n.z, -n.y / n.z} : Vec2{};
}
Vec2 slope_of(const Corners& t) {
  return slope_of(t[1] - t[0], t[2] - t[0]);
}

// Where two edges cross in the plane: shares of their ways.
std::optional<Vec2> crossing(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const double at_a = side_of(a, c, d), at_b = side_of(b, c, d), at_c = side_of(c, a, b), at_d = side_of(d, a, b);
  if ((at_a > 0) == (at_b > 0) || (at_c > 0) == (at_d > 0)) return {};
  const Vec2 share{at_a / (at_a - at_b), at_c / (at_c - at_d)};
  if (!std::isfinite(share.x) || !std::isfinite(share.y)) return {};
  return share;
}

BoxGrid grid_of(const Layered& mesh, const Faces& faces) {
  std::vector<PlaneBox> boxes;
  for (const auto& [a, b, c] : faces) boxes.push_back(box_round(mesh.at[a], mesh.at[b], mesh.at[c]));
  return BoxGrid(std::move(boxes));
}
BoxGrid grid_of(const Layered& mesh, const std::vector<Edge>& edges) {
  std::vector<PlaneBox> boxes;
  for (const auto& [a, b] : edges) boxes.push_back(box_round(mesh.at[a], mesh.at[b]));
  return BoxGrid(std::move(boxes));
}

double between(double a, double b, double share) {
  return a + share * (b - a);
}

// The hard mesh's underside: what of it faces down.
Layered underside(const Layered& hard) {
  Layered under{hard.at, {}};
  for (std::uint32_t f = 0; f < hard.faces.size(); ++f)
    if (faces_down(corners_of(hard, f))) under.faces.push_back(hard.faces[f]);
  return under;
}

class RowsBelow {
 public:
  RowsBelow(const Layered& soft, const Layered& hard, const Below& wish)
      : soft_(soft), under_(underside(hard)), wish_(wish) {}

  std::vector<Row> all() {
    mark_gripped_edges();
    at_soft_vertices();
    at_edges();
    at_hard_vertices();
    return std::move(rows_);
  }

 private:
  // `gap`: how much deeper the hard surface lies than the soft one.
  void demand(Row row, double gap, bool gripped) {
    if (gap < -wish_.window || gap > (gripped ? wish_.window : 0)) return;
    row.bound = gap + wish_.clearance;
    rows_.push_back(row);
  }
  bool any_free(std::span<const std::uint32_t> vertices) const {
    return std::ranges::any_of(vertices, [&](std::uint32_t v) { return wish_.free[v] != 0; });
  }
  void mark_gripped_edges() {
    edges_ = edges_of(soft_.faces);
    edge_gripped_.assign(edges_.size(), 0);
    for (std::size_t f = 0; f < soft_.faces.size(); ++f)
      if (wish_.gripped[f] != 0)
        for (std::size_t k = 0; k < 3; ++k) {
          if (soft_.faces[f][k] == soft_.faces[f][(k + 1) % 3]) continue;
          const Edge e{std::min(soft_.faces[f][k], soft_.faces[f][(k + 1) % 3]),
                       std::max(soft_.faces[f][k], soft_.faces[f][(k + 1) % 3])};
          edge_gripped_[static_cast<std::size_t>(std::ranges::lower_bound(edges_, e) - edges_.begin())] = 1;
        }
  }
  // The deepest of what lies over or, for captives, under a vertex within the window.
  void at_soft_vertices() {
    const BoxGrid grid = grid_of(under_, under_.faces);
    for (std::uint32_t v = 0; v < soft_.at.size(); ++v) {
      if (wish_.free[v] == 0) continue;
      const Vec3 p = soft_.at[v];
      std::optional<double> deepest;
      Row row;
      row.add(v, 1);
      grid.visit(box_round(p), [&](std::uint32_t f) {
        const Corners t = corners_of(under_, f);
        const auto w = weights_at(p, t);
        if (!w) return;
        const double gap = depth_at(t, *w) - p.z;
        if (gap > (wish_.captive[v] != 0 ? wish_.window : 0) || (deepest && gap <= *deepest)) return;
        deepest = gap;
        row.slope = slope_of(t);
      });
      if (deepest) demand(row, *deepest, wish_.captive[v] != 0);
    }
  }
  void at_edges() {
    const std::vector<Edge> hard_edges = edges_of(under_.faces);
    const BoxGrid grid = grid_of(under_, hard_edges);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (!any_free(edges_[e])) continue;
      const auto [i, j] = edges_[e];
      const Vec3 a = soft_.at[i], b = soft_.at[j];
      grid.visit(box_round(a, b), [&](std::uint32_t h) {
        const Vec3 c = under_.at[hard_edges[h][0]], d = under_.at[hard_edges[h][1]];
        const auto share = crossing(a, b, c, d);
        if (!share) return;
        Row row;
        row.add(i, 1 - share->x);
        row.add(j, share->x);
        row.slope = slope_of(b - a, d - c);
        demand(row, between(c.z, d.z, share->y) - between(a.z, b.z, share->x), edge_gripped_[e] != 0);
      });
    }
  }
  void at_hard_vertices() {
    std::vector<std::uint32_t> used;
    for (const auto& face : under_.faces) used.insert(used.end(), face.begin(), face.end());
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::vector<PlaneBox> boxes;
    for (const std::uint32_t v : used) boxes.push_back(box_round(under_.at[v]));
    const BoxGrid grid(std::move(boxes));
    for (std::uint32_t f = 0; f < soft_.faces.size(); ++f) {
      if (!any_free(soft_.faces[f])) continue;
      const Corners t = corners_of(soft_, f);
      grid.visit(box_round(t[0], t[1], t[2]), [&](std::uint32_t k) {
        const Vec3 p = under_.at[used[k]];
        const auto w = weights_at(p, t);
        if (!w) return;
        Row row;
        for (std::size_t c = 0; c < 3; ++c) row.add(soft_.faces[f][c], (*w)[c]);
        row.slope = slope_of(t);
        demand(row, p.z - depth_at(t, *w), wish_.gripped[f] != 0);
      });
    }
  }

  const Layered& soft_;
  const Layered under_;
  const Below& wish_;
  std::vector<Edge> edges_;
  std::vector<std::uint8_t> edge_gripped_;
  std::vector<Row> rows_;
};

// `row` is the displacement of what lies deeper at the beginning minus that of the other, `gap` the depth between.
void keep_order(std::vector<Row>& rows, Row row, double gap, double window, double clearance) {
  if (row.count == 0 || gap == 0 || std::abs(gap) > window) return;
  const double sign = gap > 0 ? 1 : -1;
  for (std::uint32_t k = 0; k < row.count; ++k) row.weight[k] *= sign;
  row.bound = std::min(clearance, std::abs(gap) / 2) - std::abs(gap);
  rows.push_back(row);
}

}  // namespace

void Row::add(std::uint32_t v, double w) {
  if (w == 0) return;
  for (std::uint32_t k = 0; k < count; ++k)
    if (vertex[k] == v) {
      weight[k] += w;
      return;
    }
  vertex[count] = v;
  weight[count++] = w;
}

double Row::short_by(std::span<const double> u) const {
  double sum = 0;
  for (std::uint32_t k = 0; k < count; ++k) sum += weight[k] * u[vertex[k]];
  return bound - sum;
}

Vec3 Row::where(const std::vector<Vec3>& at) const {
  Vec3 p{};
  for (std::uint32_t k = 0; k < count; ++k) p += weight[k] * at[vertex[k]];
  return p;
}

std::vector<Edge> edges_of(const Faces& faces) {
  std::vector<Edge> edges;
  edges.reserve(3 * faces.size());
  for (const auto& f : faces)
    for (std::size_t k = 0; k < 3; ++k)
      if (f[k] != f[(k + 1) % 3]) edges.push_back({std::min(f[k], f[(k + 1) % 3]), std::max(f[k], f[(k + 1) % 3])});
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

std::vector<Column> columns(const std::vector<Vec3>& points, const Layered& hard, double window) {
  const BoxGrid grid = grid_of(hard, hard.faces);
  std::vector<Column> found(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points[i];
    Column& c = found[i];
    grid.visit(box_round(p), [&](std::uint32_t f) {
      const Corners t = corners_of(hard, f);
      if (!crossed_by_line(p, t)) return;
      const auto w = weights_at(p, t);
      const double gap = w ? depth_at(t, *w) - p.z : 0;
      if (gap <= 0) return;
      c.inside = !c.inside;
      if (gap <= window && faces_down(t)) c.exit = std::max(c.exit, gap);
    });
  }
  return found;
}

std::vector<Row> rows_below(const Layered& soft, const Layered& hard, const Below& wish) {
  return RowsBelow(soft, hard, wish).all();
}

std::vector<Row> rows_between_layers(const Layered& soft, const std::vector<std::uint8_t>& free, double window,
                                     double clearance) {
  std::vector<Row> rows;
  const BoxGrid faces = grid_of(soft, soft.faces);
  for (std::uint32_t v = 0; v < soft.at.size(); ++v) {
    const Vec3 p = soft.at[v];
    faces.visit(box_round(p), [&](std::uint32_t f) {
      const auto& corner = soft.faces[f];
      if (std::ranges::find(corner, v) != corner.end()) return;
      if (free[v] == 0 && free[corner[0]] == 0 && free[corner[1]] == 0 && free[corner[2]] == 0) return;
      const Corners t = corners_of(soft, f);
      const auto w = weights_at(p, t);
      if (!w) return;
      Row row;
      for (std::size_t k = 0; k < 3; ++k) row.add(corner[k], (*w)[k]);
      row.add(v, -1);
      keep_order(rows, row, depth_at(t, *w) - p.z, window, clearance);
    });
  }
  const std::vector<Edge> edges = edges_of(soft.faces);
  const BoxGrid grid = grid_of(soft, edges);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const auto [i, j] = edges[e];
    grid.visit(box_round(soft.at[i], soft.at[j]), [&](std::uint32_t other) {
      const auto [k, l] = edges[other];
      if (other <= e || i == k || i == l || j == k || j == l) return;
      if (free[i] == 0 && free[j] == 0 && free[k] == 0 && free[l] == 0) return;
      const auto share = crossing(soft.at[i], soft.at[j], soft.at[k], soft.at[l]);
      if (!share) return;
      Row row;
      row.add(k, 1 - share->y);
      row.add(l, share->y);
      row.add(i, share->x - 1);
      row.add(j, -share->x);
      keep_order(rows, row,
                 between(soft.at[k].z, soft.at[l].z, share->y) - between(soft.at[i].z, soft.at[j].z, share->x), window,
                 clearance);
    });
  }
  return rows;
}

}  // namespace gonio::reassembly::contact
