#include "mesh/adjacency.h"

namespace gonio::mesh {

VertexFaces faces_of_vertices(const std::vector<Corners>& triangles, std::size_t vertices) {
  VertexFaces all;
  all.starts.assign(vertices + 1, 0);
  for (const Corners& t : triangles)
    for (const std::uint32_t v : t) ++all.starts[v + 1];
  for (std::size_t v = 0; v < vertices; ++v) all.starts[v + 1] += all.starts[v];
  all.faces.resize(3 * triangles.size());
  std::vector<std::size_t> next(all.starts.begin(), all.starts.end() - 1);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t v : triangles[t]) all.faces[next[v]++] = t;
  return all;
}

std::vector<Corners> neighbours_of_faces(const std::vector<Corners>& triangles, std::size_t vertices) {
  const VertexFaces around = faces_of_vertices(triangles, vertices);
  std::vector<Corners> behind(triangles.size(), Corners{nobody, nobody, nobody});
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t from = triangles[t][c], to = triangles[t][(c + 1) % 3];
      std::uint32_t found = nobody;
      std::size_t claims = 0, same_way = 0;
      for (const std::uint32_t other : around.of(from))
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t a = triangles[other][k], b = triangles[other][(k + 1) % 3];
          if (a == from && b == to) ++same_way;
          if (a != to || b != from) continue;
          found = other;
          ++claims;
        }
      if (claims == 1 && same_way == 1) behind[t][c] = found;
    }
  return behind;
}

std::vector<char> rim_vertices(const std::vector<Corners>& triangles, std::size_t vertices) {
  std::vector<char> rim(vertices, 0);
  const std::vector<Corners> behind = neighbours_of_faces(triangles, vertices);
  for (std::size_t t = 0; t < behind.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c)
      if (behind[t][c] == nobody) rim[triangles[t][c]] = rim[triangles[t][(c + 1) % 3]] = 1;
  return rim;
}

}  // namespace gonio::mesh
