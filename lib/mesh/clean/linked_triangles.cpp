#include "mesh/clean/linked_triangles.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace gonio::mesh {
namespace {

[[noreturn]] void refuse_triangle(std::size_t t) {
  throw Error(Exit::data, "mesh",
              "triangle " + std::to_string(t) + " meets its neighbours in no surface: an edge or a corner there " +
                  "belongs to more than one sheet",
              "give a 2-manifold mesh");
}

}  // namespace

LinkedTriangles::LinkedTriangles(const std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t vertices)
    : corner_(3 * triangles.size()), twin_(corner_.size(), none), out_(vertices, none), stamps_(vertices, 0) {
  if (corner_.size() >= none)
    throw Error(Exit::data, "mesh", std::to_string(triangles.size()) + " triangles are more than can be linked");
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    if (a == b || b == c || c == a || std::max({a, b, c}) >= vertices) refuse_triangle(t);
    std::copy(triangles[t].begin(), triangles[t].end(), corner_.begin() + static_cast<std::ptrdiff_t>(3 * t));
  }
  link_twins();
  find_first_of_fans();
}

// Half-edges sorted by the vertex that they leave: the twin of a -> b is among those that leave b.
void LinkedTriangles::link_twins() {
  std::vector<std::uint32_t> starts(out_.size() + 1, 0), leaving(corner_.size());
  for (const std::uint32_t v : corner_) ++starts[v + 1];
  for (std::size_t v = 0; v < out_.size(); ++v) starts[v + 1] += starts[v];
  std::vector<std::uint32_t> next_free(starts.begin(), starts.end() - 1);
  for (std::uint32_t h = 0; h < corner_.size(); ++h) leaving[next_free[corner_[h]]++] = h;
  for (std::uint32_t h = 0; h < corner_.size(); ++h) {
    const std::uint32_t a = from(h), b = to(h);
    for (std::uint32_t i = starts[a]; leaving[i] < h; ++i)
      if (to(leaving[i]) == b) refuse_triangle(h / 3);
    for (std::uint32_t i = starts[b]; i < starts[b + 1]; ++i)
      if (to(leaving[i]) == a) {
        twin_[h] = leaving[i];
        break;
      }
  }
  for (std::size_t v = 0; v < out_.size(); ++v)
    if (starts[v] < starts[v + 1]) out_[v] = leaving[starts[v]];
}

// A fan at a border begins where it has nobody behind it.
void LinkedTriangles::find_first_of_fans() {
  std::vector<std::uint32_t> reached(out_.size(), 0);
  for (std::uint32_t v = 0; v < out_.size(); ++v) {
    if (isolated(v)) continue;
    out_[v] = first_of_fan(out_[v]);
    around(v, [&](std::uint32_t) { return ++reached[v], true; });
  }
  for (std::uint32_t h = 0; h < corner_.size(); ++h)
    if (reached[corner_[h]]-- == 0) refuse_triangle(h / 3);
}

std::uint32_t LinkedTriangles::first_of_fan(std::uint32_t h) const {
  const std::uint32_t start = h;
  while (twin_[h] != none) {
    h = next(twin_[h]);
    if (h == start) break;
  }
  return h;
}

int LinkedTriangles::neighbours(std::uint32_t vertex, int most) const {
  int count = 0;
  edges_from(vertex, [&](const Edge&) { return ++count < most; });
  return count;
}

bool LinkedTriangles::can_collapse(const Edge& edge) const {
  std::uint32_t beside[2] = {none, none};
  int sides = 0;
  for (const std::uint32_t h : {edge.left, edge.right}) {
    if (h == none) continue;
    const std::uint32_t v = beside[sides++] = apex(h);
    if (twin_[next(h)] == none && twin_[before(h)] == none) return false;
    if (neighbours(v, 4) <= 3 && !at_border(v)) return false;
  }
  if (sides == 0 || beside[0] == beside[1]) return false;
  if (!edge.border() && at_border(edge.from) && at_border(edge.to)) return false;
  // Who is beside both ends is beside the edge.
  ++stamp_;
  edges_from(edge.to, [&](const Edge& e) { return stamps_[e.to] = stamp_, true; });
  bool linked = true;
  edges_from(edge.from, [&](const Edge& e) {
    linked = stamps_[e.to] != stamp_ || e.to == beside[0] || e.to == beside[1];
    return linked;
  });
  return linked;
}

// The triangle of h goes; those behind its other two edges become neighbours. Returns a half-edge that leaves the
// vertex that stays, which is where h starts or ends.
std::uint32_t LinkedTriangles::join_outside(std::uint32_t h) {
  const std::uint32_t one = next(h), two = before(h), apex_vertex = from(two);
  const std::uint32_t a = twin_[one], b = twin_[two];
  if (a != none) twin_[a] = b;
  if (b != none) twin_[b] = a;
  if (out_[apex_vertex] == two) out_[apex_vertex] = a != none ? a : next(b);
  for (const std::uint32_t side : {h, one, two}) corner_[side] = none, twin_[side] = none;
  return b != none ? b : next(a);
}

std::size_t LinkedTriangles::collapse(const Edge& edge) {
  around(edge.from, [&](std::uint32_t h) { return corner_[h] = edge.to, true; });
  std::uint32_t leaving = none;
  std::size_t less = 0;
  for (const std::uint32_t h : {edge.left, edge.right}) {
    if (h == none) continue;
    leaving = join_outside(h);
    ++less;
  }
  out_[edge.to] = first_of_fan(leaving);
  out_[edge.from] = none;
  return less;
}

}  // namespace gonio::mesh
