#include "mesh/unused_vertices.h"

#include <cstdint>
#include <vector>

namespace gonio::mesh {

void drop_unused(io::TriangleMesh& mesh) {
  constexpr std::uint32_t unused = 0xffffffffu;
  std::vector<std::uint32_t> place(mesh.positions_m.size(), unused);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) place[v] = 0;
  std::uint32_t count = 0;
  for (std::uint32_t& p : place)
    if (p != unused) p = count++;
  const auto thin = [&](auto& values) {
    if (values.empty()) return;
    for (std::size_t v = 0; v < place.size(); ++v)
      if (place[v] != unused) values[place[v]] = values[v];
    values.resize(count);
  };
  thin(mesh.positions_m);
  thin(mesh.normals);
  thin(mesh.texture);
  for (auto& values : mesh.properties) thin(values);
  for (auto& t : mesh.triangles)
    for (std::uint32_t& v : t) v = place[v];
}

}  // namespace gonio::mesh
