#include "mesh/carve/opening.h"

#include <algorithm>
#include <map>

namespace gonio::mesh {
namespace {

// Triangles that stay at a vertex, as fans: more than one means that the surface hangs together there by a corner.
std::size_t fans_staying(std::uint32_t v, const std::vector<Corners>& triangles, const VertexFaces& around,
                         const std::vector<bool>& out) {
  std::map<std::uint32_t, int> ends;  // of the arcs round the vertex: an open fan has two
  std::size_t staying = 0;
  for (const std::uint32_t f : around.of(v)) {
    if (out[f]) continue;
    ++staying;
    for (const std::uint32_t w : triangles[f])
      if (w != v) ++ends[w];
  }
  const auto open = std::count_if(ends.begin(), ends.end(), [](const auto& e) { return e.second == 1; });
  return staying == 0 ? 0 : std::max<std::size_t>(1, static_cast<std::size_t>(open) / 2);
}

}  // namespace

std::size_t take_out(const io::TriangleMesh& mesh, const Neighbours& neighbours, Vec3 centre_m, double reach_m,
                     std::vector<bool>& out) {
  std::size_t taken = 0;
  std::vector<std::uint32_t> border;
  const auto take = [&](std::uint32_t f) {
    if (out[f]) return;
    out[f] = true;
    ++taken;
    for (const std::uint32_t v : mesh.triangles[f]) border.push_back(v);
  };
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
    for (const std::uint32_t v : mesh.triangles[f])
      if (norm(mesh.positions_m[v] - centre_m) < reach_m) take(f);
  if (taken == 0) return 0;
  const auto& [around, behind] = neighbours;
  while (!border.empty()) {
    std::vector<std::uint32_t> todo;
    todo.swap(border);
    std::sort(todo.begin(), todo.end());
    todo.erase(std::unique(todo.begin(), todo.end()), todo.end());
    for (const std::uint32_t v : todo) {
      const bool pinched = fans_staying(v, mesh.triangles, around, out) > 1;
      for (const std::uint32_t f : around.of(v)) {
        if (out[f]) continue;
        int open = 0;
        for (const std::uint32_t other : behind[f]) open += other != nobody && out[other];
        if (pinched || open >= 2) take(f);
      }
    }
  }
  return taken;
}

std::size_t parts_left(const Neighbours& neighbours, const std::vector<bool>& out) {
  std::vector<bool> seen = out;
  std::vector<std::uint32_t> stack;
  std::size_t parts = 0;
  for (std::uint32_t start = 0; start < seen.size(); ++start) {
    if (seen[start]) continue;
    ++parts;
    seen[start] = true;
    stack.push_back(start);
    while (!stack.empty()) {
      const std::uint32_t f = stack.back();
      stack.pop_back();
      for (const std::uint32_t other : neighbours.behind[f])
        if (other != nobody && !seen[other]) {
          seen[other] = true;
          stack.push_back(other);
        }
    }
  }
  return parts;
}

std::vector<std::vector<std::uint32_t>> opened_loops(const io::TriangleMesh& mesh, const Neighbours& neighbours,
                                                     const std::vector<bool>& out) {
  const std::vector<Corners>& behind = neighbours.behind;
  std::map<std::uint32_t, std::uint32_t> next;  // a new triangle passes the edge as the old one did
  for (std::uint32_t f = 0; f < out.size(); ++f) {
    if (!out[f]) continue;
    for (std::size_t c = 0; c < 3; ++c)
      if (behind[f][c] != nobody && !out[behind[f][c]]) next[mesh.triangles[f][c]] = mesh.triangles[f][(c + 1) % 3];
  }
  std::vector<std::vector<std::uint32_t>> loops;
  while (!next.empty()) {
    std::vector<std::uint32_t> loop;
    for (auto at = next.begin(); at != next.end(); at = next.find(loop.back())) {
      if (loop.empty()) loop.push_back(at->first);
      const std::uint32_t to = at->second;
      next.erase(at);
      if (to == loop.front()) break;
      loop.push_back(to);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace gonio::mesh
