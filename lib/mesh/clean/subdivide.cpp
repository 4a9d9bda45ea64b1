// Subdivision on half-edges (OpenMesh).
#ifndef NDEBUG
#define NDEBUG  // OpenMesh asserts in every step from a half-edge to the next
#endif
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/Sqrt3T.hh>
#include <algorithm>

#include "base/error.h"
#include "mesh/clean.h"
#include "mesh/mesh.h"

namespace gonio::mesh {
namespace {

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

}  // namespace

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
