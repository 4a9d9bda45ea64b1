#include "volume/polygons.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace gonio::volume {
namespace {

constexpr double envelope_margin = 1e-6;

// The four cells round an edge, counter-clockwise seen from its upper end.
struct Ring {
  std::array<const Cell*, 4> cell{};
  std::array<std::uint32_t, 4> vertex{};  // of the sheet that crosses the edge; nothing for a tunnel
  std::array<bool, 4> drawn_face{};       // between cell n and n + 1: its segments are drawn as they are
  bool any_drawn = false;
};

constexpr std::array<std::array<int, 2>, 4> ring_offsets{{{-1, -1}, {0, -1}, {0, 0}, {-1, 0}}};

Ring ring_round(const Layers& layers, const Cell& owner, std::size_t row, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  Ring ring;
  bool marked = false;
  for (std::size_t n = 0; n < 4; ++n) {
    std::array<std::size_t, 3> down{};
    down[static_cast<std::size_t>(u)] = ring_offsets[n][0] < 0;
    down[static_cast<std::size_t>(v)] = ring_offsets[n][1] < 0;
    ring.cell[n] = n == 2 ? &owner : &layers.layer[2 - down[2]]->at(owner.column - down[0], row - down[1]);
    ring.vertex[n] = ring.cell[n]->first_vertex;
    marked = marked || ring.cell[n]->kind().marked;
  }
  if (!marked) return ring;
  const std::array<int, 4> faces{2 * u + 1, 2 * v + 1, 2 * u, 2 * v};
  for (std::size_t n = 0; n < 4; ++n) {
    const CellCase& kind = ring.cell[n]->kind();
    const int corner = (ring_offsets[n][0] < 0 ? 1 << u : 0) | (ring_offsets[n][1] < 0 ? 1 << v : 0);
    if (!kind.tunnel) ring.vertex[n] += kind.sheet_of[static_cast<std::size_t>(cell_edge(axis, corner))];
    ring.drawn_face[n] = kind.shared || ring.cell[(n + 1) % 4]->kind().shared || (kind.ambiguous >> faces[n] & 1) != 0;
    ring.any_drawn = ring.any_drawn || ring.drawn_face[n];
  }
  return ring;
}

// A cell's vertex seen along an edge: across it, and the height above its lower end.
struct Seen {
  double u = 0, v = 0, height = 0;
};
double cross2(const Seen& a, const Seen& b) {
  return a.u * b.v - a.v * b.u;
}
Seen between(const Seen& a, const Seen& b) {  // b - a
  return {b.u - a.u, b.v - a.v, b.height - a.height};
}

// The height at which the edge passes the two triangles on either side of the diagonal from vertex `first` to the one
// opposite; nothing where they leave the edge's envelope. The vertices lie in the four quadrants round the edge, so it
// passes one of the triangles, between its own ends. The diagonal passes between the edge and vertex `near` of the
// other one. It stays in the two tetrahedra there if it crosses the triangle of edge and `near` that they share: at
// share `s` of the way to `near`, that one spans heights s height(near) ... s height(near) + 1 - s.
std::optional<double> height_of_diagonal(const std::array<Seen, 4>& corner, std::size_t first) {
  const Seen &p = corner[first], &q = corner[first + 2];
  const double turn = cross2(p, q);
  const Seen& near = corner[turn >= 0 ? first + 1 : (first + 3) % 4];
  const Seen& far = corner[turn >= 0 ? (first + 3) % 4 : first + 1];
  const Seen way = between(p, q);
  const double s = turn / cross2(near, way);
  const double along = -cross2(p, near) / cross2(way, near);
  const double height = p.height + along * way.height;
  const double low = s * near.height, high = low + 1 - s;
  if (!(s <= 1 - envelope_margin && height >= low + envelope_margin && height <= high - envelope_margin)) return {};
  const double of_p = cross2(q, far), of_q = cross2(far, p), of_far = turn;
  return (of_p * p.height + of_q * q.height + of_far * far.height) / (of_p + of_q + of_far);
}

// Which of the two diagonals splits the plain quad so that it stays in the envelope and passes nearest to the crossing;
// of two that are as good, the shorter. Nothing: neither stays.
std::optional<std::size_t> diagonal(const Ring& ring, std::span<const Position> positions,
                                    const std::array<double, 3>& origin, int axis, double crossing) {
  const auto a = static_cast<std::size_t>(axis), u = (a + 1) % 3, v = (a + 2) % 3;
  std::array<Seen, 4> corner;
  for (std::size_t n = 0; n < 4; ++n) {
    const Position& at = positions[ring.vertex[n]];
    corner[n] = {static_cast<double>(at[u]) - origin[u], static_cast<double>(at[v]) - origin[v],
                 static_cast<double>(at[a]) - origin[a]};
  }
  const std::optional<double> one = height_of_diagonal(corner, 0), other = height_of_diagonal(corner, 1);
  if (!one || !other) return one ? std::optional<std::size_t>(0) : other ? std::optional<std::size_t>(1) : std::nullopt;
  const double better = std::abs(*other - crossing) - std::abs(*one - crossing);
  if (std::abs(better) > 1e-3) return better > 0 ? 0 : 1;
  const auto length = [](const Seen& d) { return d.u * d.u + d.v * d.v + d.height * d.height; };
  return length(between(corner[0], corner[2])) <= length(between(corner[1], corner[3])) ? 0 : 1;
}

std::array<double, 3> lowest_corner(const Cell& cell, std::size_t row, std::size_t layer) {
  return {static_cast<double>(cell.column) - 1, static_cast<double>(row) - 1, static_cast<double>(layer) - 1};
}

Position position_of(const std::array<double, 3>& origin, Vec3 local) {
  return {static_cast<float>(origin[0] + local.x), static_cast<float>(origin[1] + local.y),
          static_cast<float>(origin[2] + local.z)};
}

// Triangles round the crossing, one for each face whose segments are not drawn.
void draw_fan(const Ring& ring, bool upwards, const Neighbourhood& near, const std::array<double, 3>& origin, int axis,
              double threshold, Drawn& drawn) {
  const Crossing at = crossing(near, cell_edge(axis, 0), threshold);
  const auto own = static_cast<std::uint32_t>(drawn.positions.size());
  drawn.positions.push_back(position_of(origin, at.point));
  drawn.normals.push_back(position_of({}, at.normal));
  for (std::size_t n = 0; n < 4; ++n) {
    if (ring.drawn_face[n]) continue;
    const std::uint32_t a = ring.vertex[n], b = ring.vertex[(n + 1) % 4];
    drawn.fans.push_back(upwards ? Triangle{own, a, b} : Triangle{own, b, a});
  }
}

void draw_quad(const Ring& ring, std::size_t first, bool upwards, std::vector<Triangle>& triangles) {
  const std::uint32_t a = ring.vertex[first], b = ring.vertex[first + 1], c = ring.vertex[first + 2],
                      d = ring.vertex[(first + 3) % 4];
  triangles.push_back(upwards ? Triangle{a, b, c} : Triangle{a, c, b});
  triangles.push_back(upwards ? Triangle{a, c, d} : Triangle{a, d, c});
}

// The number of the vertex at an edge's crossing, for a cell of the layer below `here`.
std::uint32_t crossing_vertex(const Layers& layers, const Cell& cell, std::size_t row, int edge) {
  const int low = lower_corner(edge);
  const auto x = static_cast<std::size_t>(low & 1), y = static_cast<std::size_t>(low >> 1 & 1),
             z = static_cast<std::size_t>(low >> 2);
  const Cell& owner = low == 0 ? cell : layers.layer[1 + z]->at(cell.column + x, row + y);
  return owner.crossing_vertex(edge / 4);
}

// A tunnel's strip: over the segment on a face, with the crossing of the edge along that face's axis at the corner
// opposite to the one that the segment cuts off. Six such triangles run once round the diagonal; along it they rise
// from one loop to the other, so that no two meet but in their edges.
int tunnel_apex(const Cell& cell, int edge, int face) {
  const int low = lower_corner(edge);
  const int cut_off = (cell.mask >> low & 1) == 0 ? low : upper_corner(edge);
  return cell_edge(face / 2, cut_off ^ 7);
}

void draw_faces_of(const Layers& layers, const Cell& cell, std::size_t row, std::vector<Triangle>& triangles) {
  const CellCase& kind = cell.kind();
  for (std::size_t edge = 0; edge < 12; ++edge) {
    const int e = static_cast<int>(edge), low = lower_corner(e), high = upper_corner(e);
    if ((cell.mask >> low & 1) == (cell.mask >> high & 1)) continue;
    const int face = kind.next_face[edge], axis = face / 2;
    const std::size_t up = face % 2 == 1 ? 2 : 0;  // one more than the step
    const Cell& beyond =
        axis == 2 ? layers.layer[up]->at(cell.column, row)
                  : layers.layer[1]->at(axis == 0 ? cell.column + up - 1 : cell.column, axis == 1 ? row + up - 1 : row);
    const CellCase& other = beyond.kind();
    if (!kind.shared && !other.shared && (kind.ambiguous >> face & 1) == 0) continue;
    std::uint32_t p = crossing_vertex(layers, cell, row, e), q = crossing_vertex(layers, cell, row, kind.next[edge]);
    if (!layers.separate_inside) std::swap(p, q);
    const std::uint32_t own = kind.tunnel ? crossing_vertex(layers, cell, row, tunnel_apex(cell, e, face))
                                          : cell.first_vertex + kind.sheet_of[edge];
    triangles.push_back({own, p, q});
    if (!other.marked) triangles.push_back({beyond.first_vertex, q, p});
  }
}

}  // namespace

void Drawn::clear() {
  positions.clear();
  normals.clear();
  triangles.clear();
  fans.clear();
  crossed_edges = split_polygons = 0;
}

RowsRound rows_round(const SampleWindow& window, const std::array<std::size_t, 3>& size, std::size_t row,
                     std::size_t layer) {
  const auto clamped = [](std::size_t first, std::size_t count) {
    std::array<std::size_t, 4> at{};
    for (std::size_t n = 0; n < 4; ++n) at[n] = std::min(first + n < 2 ? 0 : first + n - 2, count - 1);
    return at;
  };
  const auto per = [](const std::array<std::size_t, 4>& at) {
    return std::array{at[2] - at[0] == 2 ? 0.5f : 1.0f, at[3] - at[1] == 2 ? 0.5f : 1.0f};
  };
  const std::array<std::size_t, 4> y = clamped(row, size[1]), z = clamped(layer, size[2]);
  RowsRound round;
  round.width = size[0];
  round.per_y = per(y);
  round.per_z = per(z);
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t j = 0; j < 4; ++j) round.row[k][j] = window.row(y[j], z[k]);
  if (row == 0) round.missing |= 0x33;
  if (row == size[1]) round.missing |= 0xcc;
  if (layer == 0) round.missing |= 0x0f;
  if (layer == size[2]) round.missing |= 0xf0;
  return round;
}

void draw_polygons(const Layers& layers, std::size_t row, const RowsRound& samples, Drawn& drawn) {
  CellLayer& here = *layers.layer[2];
  const int inside_in_s = layers.separate_inside ? 1 : 0;
  for (std::uint32_t c = here.row_first[row]; c < here.row_first[row + 1]; ++c) {
    Cell& cell = here.cells[c];
    cell.first_crossing = static_cast<std::uint32_t>(drawn.positions.size());
    const int low = cell.mask & 1;
    for (int axis = 0; axis < 3; ++axis) {
      if ((cell.mask >> (1 << axis) & 1) == low) continue;
      ++drawn.crossed_edges;
      const bool upwards = low == inside_in_s;  // the surface faces along the axis: its lower end is inside
      const Ring ring = ring_round(layers, cell, row, axis);
      const std::array<double, 3> origin = lowest_corner(cell, row, layers.here);
      if (!ring.any_drawn) {
        const double at = crossing_along(samples, cell.column, axis, layers.threshold);
        if (const auto first = diagonal(ring, layers.positions, origin, axis, at)) {
          draw_quad(ring, *first, upwards, drawn.triangles);
          continue;
        }
      }
      ++drawn.split_polygons;
      cell.crossings = static_cast<std::uint8_t>(cell.crossings | 1 << axis);
      draw_fan(ring, upwards, neighbourhood(samples, cell.column), origin, axis, layers.threshold, drawn);
    }
  }
}

void draw_faces(const Layers& layers, std::size_t row, Drawn& drawn) {
  const CellLayer& layer = *layers.layer[1];
  for (std::uint32_t c = layer.row_first[row]; c < layer.row_first[row + 1]; ++c)
    if (layer.cells[c].kind().marked) draw_faces_of(layers, layer.cells[c], row, drawn.triangles);
}

}  // namespace gonio::volume
