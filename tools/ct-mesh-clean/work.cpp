// What the steps share: from indices to metres, and the entry of a step.
#include "tools/ct-mesh-clean/work.h"

#include <algorithm>

namespace gonio::tools::ct_mesh_clean {

io::TriangleMesh in_metres(const Work& work, const volume::Contour& contour) {
  io::TriangleMesh mesh;
  mesh.positions_m.reserve(contour.positions.size());
  mesh.normals.reserve(contour.normals.size());
  for (const auto& p : contour.positions) mesh.positions_m.push_back(work.grid.metres({p[0], p[1], p[2]}));
  const Vec3 shrink{1 / work.grid.spacing_m.x, 1 / work.grid.spacing_m.y,
                    1 / work.grid.spacing_m.z};  // gradients are covariant
  for (const auto& n : contour.normals) {
    const Vec3 turned = work.grid.axes * (shrink * Vec3{n[0], n[1], n[2]});
    const double length = norm(turned);
    mesh.normals.push_back(length > 0 ? turned / length : Vec3{0, 0, 1});
  }
  mesh.triangles = contour.triangles;
  if (work.grid.left_handed())
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

std::size_t object_material(const Work& work) {
  const auto& materials = work.look.mixture.materials;
  if (!work.asked.find_markers || work.asked.marker_threshold || materials.size() < work.look.air + 3)
    return work.look.object;
  std::size_t largest = work.look.air + 1;
  for (std::size_t m = largest; m + 1 < materials.size(); ++m)
    if (materials[m].share > materials[largest].share) largest = m;
  return largest;
}

void show(Work& work, const char* stage, const io::TriangleMesh& mesh) {
  if (work.with_page) work.stages.push_back({stage, mesh.positions_m, mesh.triangles});
}

manifest::VolumeStep& step(Work& work, const char* name, std::string how) {
  return work.steps.emplace_back(
      manifest::VolumeStep{.name = name, .how = std::move(how), .figures = {}, .picture = ""});
}

}  // namespace gonio::tools::ct_mesh_clean
