// The answer in the manifest: meshes as PLY files, the volume with its steps, the markers, and the piece in the scene.
#include <algorithm>

#include "base/atomic_file.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

std::string enter_mesh(Work& work, const std::string& name, const io::TriangleMesh& mesh) {
  const std::filesystem::path path = work.call.output_path(file_stem(name) + ".ply");
  io::write_ply(path, mesh);
  work.call.document.meshes[name] = manifest::Mesh{.file = manifest::add_file(work.call.document, path, name),
                                                   .sphere_radius_m = {},
                                                   .plane_size_m = {},
                                                   .normals = "smooth"};
  return name;
}

std::vector<std::vector<double>> matrix_of(const Work& work) {
  const Mat3& a = work.grid.axes;
  const Vec3 s = work.grid.spacing_m, o = work.grid.origin_m;
  return {{a(0, 0) * s.x, a(0, 1) * s.y, a(0, 2) * s.z, o.x},
          {a(1, 0) * s.x, a(1, 1) * s.y, a(1, 2) * s.z, o.y},
          {a(2, 0) * s.x, a(2, 1) * s.y, a(2, 2) * s.z, o.z},
          {0, 0, 0, 1}};
}

// Covariance of index coordinates in metres: A C A^T with A = axes * diag(spacing).
std::vector<double> covariance_in_metres(const Work& work, const std::array<double, 9>& index) {
  Mat3 a, c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      a(i, j) = work.grid.axes(i, j) * work.grid.spacing_m[j];
      c(i, j) = index[static_cast<std::size_t>(3 * i + j)];
    }
  const Mat3 turned = a * c * transposed(a);
  return {turned.m.begin(), turned.m.end()};
}

void enter_markers(Work& work) {
  auto& all = work.call.document.markers;
  std::erase_if(all, [&](const manifest::Marker& m) { return m.volume == work.name; });
  for (std::size_t i = 0; i < work.markers.found.size(); ++i) {
    const volume::Marker& m = work.markers.found[i];
    const Vec3 centre = work.grid.metres(m.centre);
    all.push_back({.id = work.name + "-" + std::to_string(i + 1),
                   .object = work.name,
                   .volume = work.name,
                   .centre_m = {centre.x, centre.y, centre.z},
                   .radius_m = m.radius * work.voxel_m(),
                   .covariance_m2 = covariance_in_metres(work, m.covariance),
                   .sigma = {{"radius_m", {m.sigma_radius * work.voxel_m()}}},
                   .cover = m.cover,
                   .seen_in = {}});
  }
}

void enter_object(Work& work) {
  manifest::Document& d = work.call.document;
  if (!d.surfaces.contains(work.asked.surface)) {
    manifest::Surface glass;
    glass.model = "dielectric";
    glass.parameters["eta"] = work.asked.index;
    d.surfaces[work.asked.surface] = std::move(glass);
  }
  for (manifest::Object& o : d.objects)
    if (o.id == work.name) {  // it keeps its place in the world
      o.mesh = work.name, o.surface = work.asked.surface;
      return;
    }
  d.objects.push_back({.id = work.name, .mesh = work.name, .surface = work.asked.surface, .world_from_object = {}});
}

}  // namespace

void enter(Work& work) {
  manifest::Document& d = work.call.document;
  manifest::Volume& entry = d.volumes[work.name];
  const io::VolumeHead& head = work.file->head();
  entry = {};
  for (std::size_t i = 0; i < head.files.size(); ++i) {
    const std::string id =
        manifest::add_file(d, head.files[i], work.name + (i == 0 ? "-volume" : "-slice-" + std::to_string(i)));
    if (i == 0)
      entry.file = id;
    else
      entry.slices.push_back(id);
  }
  for (const std::size_t n : head.size) entry.size.push_back(static_cast<std::int64_t>(n));
  entry.spacing_m = {work.grid.spacing_m.x, work.grid.spacing_m.y, work.grid.spacing_m.z};
  entry.volume_from_index = manifest::IndexMap{matrix_of(work)};
  entry.type = io::name_of(head.type), entry.value = head.value;
  if (work.asked.file.tiles)
    for (const std::size_t n : *work.asked.file.tiles) entry.tiles.push_back(static_cast<std::int64_t>(n));
  entry.threshold = work.threshold.value;
  entry.connectivity = work.asked.inside == volume::Connectivity::six ? "6" : "26";
  if (work.threshold.sigma > 0) entry.sigma["threshold"] = {work.threshold.sigma};
  entry.mesh = enter_mesh(work, work.name, work.mesh);
  if (work.call.given("reference")) {
    const std::string name = work.name + "-reference";
    d.meshes[name] = manifest::Mesh{.file = manifest::add_file(d, work.call.text("reference"), name),
                                    .sphere_radius_m = {},
                                    .plane_size_m = {},
                                    .normals = "smooth"};
    entry.reference = name;
  }
  if (!work.markers.found.empty()) {
    entry.markers_mesh = enter_mesh(work, work.name + "-markers", work.markers_mesh);
    enter_markers(work);
  }
  entry.sound = work.sound;
  for (StepPicture& picture : work.pictures) {
    if (work.call.out.empty()) break;
    const std::filesystem::path path = work.call.output_path(work.name + "-" + file_stem(picture.title) + ".png");
    write_file(path, picture.png);
    const std::string id = manifest::add_file(d, path, work.name + "-" + file_stem(picture.title));
    for (manifest::VolumeStep& s : work.steps)
      if (s.name == picture.step) s.picture = id;
  }
  entry.steps = work.steps;
  enter_object(work);
}

}  // namespace gonio::tools::ct_mesh_clean
