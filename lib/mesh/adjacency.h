// Who is next to whom in a triangle mesh, by indices alone (topology.h welds places).
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gonio::mesh {

using Corners = std::array<std::uint32_t, 3>;
constexpr std::uint32_t nobody = 0xffffffffu;

// The triangles of each vertex, one list after the other.
struct VertexFaces {
  std::vector<std::size_t> starts;  // vertices + 1
  std::vector<std::uint32_t> faces;
  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return {faces.data() + starts[vertex], starts[vertex + 1] - starts[vertex]};
  }
};
VertexFaces faces_of_vertices(const std::vector<Corners>& triangles, std::size_t vertices);

// Behind each edge (corner c to corner c + 1) the triangle that passes it the other way; `nobody` where there is none
// or where more than one claims it.
std::vector<Corners> neighbours_of_faces(const std::vector<Corners>& triangles, std::size_t vertices);

// Of every vertex, whether it ends an edge behind which there is nobody: 1 or 0.
std::vector<char> rim_vertices(const std::vector<Corners>& triangles, std::size_t vertices);

}  // namespace gonio::mesh
