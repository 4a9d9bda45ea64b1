// Points on deforming surfaces (animatronic.h).
#include "nrsfm/make/animatronic.h"

#include <Eigen/LU>

namespace gonio::nrsfm {

Shapes anchored(const DeformingSurface& surface) {
  Shapes points(surface.vertices_m.rows(), static_cast<Eigen::Index>(surface.anchors.size()));
  for (std::size_t p = 0; p < surface.anchors.size(); ++p) {
    const Anchor& a = surface.anchors[p];
    points.col(static_cast<Eigen::Index>(p)) =
        on_triangle(surface.vertices_m, surface.triangles[a.triangle], a.b1, a.b2);
  }
  return points;
}

bool inside(const RigBox& box, const Eigen::Vector3d& point_m, double margin_m) {
  const Eigen::Vector3d p = box.world_from_box.inverse() * point_m;
  return (p.cwiseAbs().array() < box.half_m.array() + margin_m).all();
}

const Animatronic* find_animatronic(const std::string& id) {
  for (const Animatronic* animatronic : all_animatronics())
    if (animatronic->info().id == id) return animatronic;
  return nullptr;
}

}  // namespace gonio::nrsfm
