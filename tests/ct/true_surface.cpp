// The true surface of a phantom: ct/true_surface.h.
#include "ct/true_surface.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "volume/contour.h"

namespace gonio::ct {
namespace {

// Signed distance to the glass: the first part's, or, where several parts are of it, their union's.
double distance_of(const Phantom& phantom, Vec3 p) {
  double nearest = 1e9;
  for (std::size_t part = 0; part < phantom.parts.size(); ++part)
    if (phantom.parts[part].name != "markers") nearest = std::min(nearest, phantom.distance_m(p, part));
  return nearest;
}

Vec3 gradient_of(const Phantom& phantom, Vec3 p, double h) {
  const auto at = [&](Vec3 d) { return distance_of(phantom, p + d) - distance_of(phantom, p - d); };
  return Vec3{at({h, 0, 0}), at({0, h, 0}), at({0, 0, h})} / (2 * h);
}

}  // namespace

io::TriangleMesh true_surface(const Phantom& phantom, const Scanner& scanner, std::size_t finer) {
  const std::size_t side = finer * scanner.voxels, high = finer * scanner.slice_count();
  const double step = scanner.voxel_m / static_cast<double>(finer);
  io::VolumeData field;
  field.head.size = {side, side, high}, field.head.type = io::VoxelType::f32;
  field.values.resize(side * side * high);
  const auto place = [&](double i, double j, double k) {
    const double middle = 0.5 * (static_cast<double>(side) - 1), half = 0.5 * (static_cast<double>(high) - 1);
    return Vec3{(i - middle) * step, (j - middle) * step, (k - half) * step};
  };
  parallel_for(0, high, [&](std::size_t k) {
    for (std::size_t j = 0; j < side; ++j)
      for (std::size_t i = 0; i < side; ++i)
        field.values[(k * side + j) * side + i] = static_cast<float>(
            -distance_of(phantom, place(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k))));
  });
  const volume::Contour contour = volume::contour(*io::source_of(std::move(field)), {});
  io::TriangleMesh mesh;
  mesh.triangles = contour.triangles;
  mesh.positions_m.resize(contour.positions.size());
  mesh.normals.resize(contour.positions.size());
  parallel_for(
      0, contour.positions.size(),
      [&](std::size_t v) {
        Vec3 p = place(contour.positions[v][0], contour.positions[v][1], contour.positions[v][2]);
        for (int n = 0; n < 4; ++n) {
          const Vec3 g = gradient_of(phantom, p, 0.01 * step);
          const double steep = dot(g, g), shift = distance_of(phantom, p);
          if (!(steep > 0.25) || std::abs(shift) > step) break;  // a crease: stays where the contour put it
          p += g * (-shift / steep);
        }
        const Vec3 n = gradient_of(phantom, p, 0.05 * step);
        mesh.positions_m[v] = p;
        mesh.normals[v] = norm(n) > 0 ? n / norm(n) : Vec3{0, 0, 1};
      },
      256);
  return mesh;
}

}  // namespace gonio::ct
