// A plate of actual ridges as a goniometer sees it: a mesh of prisms, path traced. Nothing here knows the analytic
// model; surface/ridges.h has the frame and the angles. Facets are smooth to the mesh and rough by their surface.
#pragma once
#include <algorithm>
#include <string>

#include "camera/intrinsics.h"
#include "io/ply.h"
#include "manifest/sections/flat_patch.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "recordings.h"

namespace gonio::tests {

struct RidgePlate {
  double ridge_rad = 12 * degree, azimuth_rad = 37 * degree, alpha = 0.2;
  std::vector<double> eta = {1.5, 1.52, 1.55}, k = {0, 0, 0};  // a resin, black within
  double pitch_m = 1e-4, half_m = 0.0022, radius_m = 0.0015;   // of the plate, and of the patch
};

// Crests in the plane z = 0; u along the ridges, turned from x by the azimuth; v = n x u, towards which facets lean.
inline io::TriangleMesh ridge_mesh(const RidgePlate& plate) {
  io::TriangleMesh mesh;
  const double c = std::cos(plate.ridge_rad), s = std::sin(plate.ridge_rad);
  const Vec3 u{std::cos(plate.azimuth_rad), std::sin(plate.azimuth_rad), 0}, v{-u.y, u.x, 0};
  const int count = static_cast<int>(std::ceil(plate.half_m / plate.pitch_m));
  const auto strip = [&](double v0, double z0, double v1, double z1) {
    const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
    for (const auto& [at, height] : {std::pair{v0, z0}, std::pair{v1, z1}})
      for (const double along : {-plate.half_m, plate.half_m})
        mesh.positions_m.push_back(u * along + v * at + Vec3{0, 0, height});
    mesh.triangles.push_back({first, first + 1, first + 3});
    mesh.triangles.push_back({first, first + 3, first + 2});
  };
  for (int i = -count; i < count; ++i) {
    const double crest = i * plate.pitch_m, trough = crest + plate.pitch_m * c * c, low = -plate.pitch_m * c * s;
    strip(crest, 0, trough, low);
    strip(trough, low, crest + plate.pitch_m, 0);
  }
  return mesh;
}

struct RidgeViews {
  std::vector<double> light_thetas_rad = {15 * degree, 35 * degree, 55 * degree};
  std::vector<double> light_phis_rad = {0, pi / 2};
  int cameras = 24;
  double camera_theta_rad = 65 * degree;  // the largest
  int width_px = 48;
  double camera_m = 0.4;
};

inline manifest::Document ridge_recording(const RidgePlate& plate, const RidgeViews& views,
                                          const std::filesystem::path& folder) {
  manifest::Document d;
  d.folder = folder;
  io::write_ply(folder / "ridges.ply", ridge_mesh(plate));
  d.meshes["ridges"].file = manifest::add_file(d, folder / "ridges.ply", "ridges");
  d.meshes["ridges"].normals = "flat";
  d.surfaces["facets"].model = "beckmann-conductor";
  d.surfaces["facets"].parameters = {{"eta", plate.eta}, {"k", plate.k}, {"alpha", plate.alpha}};
  d.objects.push_back({.id = "plate", .mesh = "ridges", .surface = "facets"});
  manifest::FlatPatch& patch = d.goniometer["plate"];
  patch.world_from_sample.emplace();
  patch.radius_m = plate.radius_m;
  camera::enter_pinhole(d, "camera", views.width_px, views.width_px,
                        views.width_px * views.camera_m / (2.4 * plate.radius_m));
  for (const double theta : views.light_thetas_rad)
    for (const double phi : views.light_phis_rad) {
      const std::string lamp = "lamp-" + std::to_string(d.lights.size());
      const Vec3 towards = direction(theta, phi);
      d.lights[lamp].model = "directional";
      d.lights[lamp].parameters = {{"towards", std::vector<double>{towards.x, towards.y, towards.z}},
                                   {"watt_per_m2", 1.0}};
      for (int i = 0; i < views.cameras; ++i) {  // evenly over the cap: a spiral of the golden angle
        const double cosine = 1 - (i + 0.5) / views.cameras * (1 - std::cos(views.camera_theta_rad));
        add_image(d, lamp + "-" + std::to_string(i), {lamp, std::acos(cosine), i * 2.399963229728653}, views.camera_m);
      }
    }
  return d;
}

}  // namespace gonio::tests
