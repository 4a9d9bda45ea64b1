// See volumes_problem.h: from the manifest to a volume and a mesh in the scanner's frame.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/switched_on.h"
#include "explain/volumes/volumes_problem.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/volume.h"

namespace gonio::explain {
namespace {

const manifest::Mesh* mesh_of(const manifest::Document& document, const manifest::Volume& volume) {
  const auto found = document.meshes.find(volume.reference);
  return found == document.meshes.end() || found->second.file.empty() ? nullptr : &found->second;
}

// scanner = axes' (p - origin) - diag(spacing) (size - 1) / 2
Vec3 scanner_from_volume(const io::VolumeGrid& grid, Vec3 p, const std::array<std::size_t, 3>& size) {
  const Vec3 last{static_cast<double>(size[0]) - 1, static_cast<double>(size[1]) - 1, static_cast<double>(size[2]) - 1};
  return grid.along_axes(p) - grid.spacing_m * last * 0.5;
}

// What the manifest says, else the file.
io::VolumeGrid grid_of(const manifest::Volume& volume, const io::VolumeHead& head, const std::string& place) {
  io::VolumeGrid grid;
  if (volume.volume_from_index) {
    const std::vector<std::vector<double>>& rows = volume.volume_from_index->matrix;
    const auto column = [&](std::size_t c) { return Vec3{rows.at(0).at(c), rows.at(1).at(c), rows.at(2).at(c)}; };
    grid.spacing_m = {norm(column(0)), norm(column(1)), norm(column(2))};
    grid.origin_m = column(3);
    for (int c = 0; c < 3; ++c) {
      const Vec3 unit = column(static_cast<std::size_t>(c)) / grid.spacing_m[c];
      for (int r = 0; r < 3; ++r) grid.axes(r, c) = unit[r];
    }
  } else {
    if (!head.spacing_m)
      throw Error(Exit::data, place, "says no voxel size, and neither does its file",
                  "give spacing_m or volume_from_index");
    grid = io::grid_of(head);
  }
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < a; ++b)
      if (!(std::abs(dot(grid.axis(a), grid.axis(b))) < 1e-3))
        throw Error(Exit::data, place, "has axes that are not at right angles", "resample it onto a straight grid");
  return grid;
}

// The object's place in the frame that volume_from_index leads to, where an object has the mesh.
Rigid<frame::World, frame::Object> pose_of(const manifest::Document& document, const std::string& mesh) {
  for (const manifest::Object& object : document.objects)
    if (object.mesh == mesh && object.world_from_object) return *object.world_from_object;
  return {};
}

// `led` takes the frame of volume_from_index to the scanner's.
template <class Led>
mesh::Mesh believed(const manifest::Document& document, const manifest::Volume& volume, bool turns_over,
                    const Led& led) {
  const std::string at = "/meshes/" + volume.reference + "/file";
  io::TriangleMesh raw = io::read_ply(manifest::resolve(document, mesh_of(document, volume)->file, at));
  raw.normals.clear();
  mesh::Mesh mesh = mesh::prepare(std::move(raw), mesh::Shading::smooth, manifest::place(document, at));
  const Rigid<frame::World, frame::Object> pose = pose_of(document, volume.reference);
  for (Vec3& p : mesh.positions_m) p = led(pose * p);
  if (turns_over)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  mesh.normals = mesh::averaged_normals(mesh.positions_m, mesh.triangles);
  return mesh;
}

VolumesInput read_input(const manifest::Document& document, const std::string& name, const manifest::Volume& volume) {
  VolumesInput input;
  input.name = name, input.mesh_name = volume.reference;
  input.place = manifest::place(document, "/volumes/" + name);
  if (volume.file.empty()) throw Error(Exit::data, input.place, "names no file", "give the volume: \"file\": id");
  io::VolumeWish wish;
  if (volume.spacing_m.size() == 3)
    wish.spacing_m = Vec3{volume.spacing_m[0], volume.spacing_m[1], volume.spacing_m[2]};
  if (volume.tiles.size() == 2)
    wish.tiles = {static_cast<std::size_t>(volume.tiles[0]), static_cast<std::size_t>(volume.tiles[1])};
  input.volume = io::read_volume(manifest::resolve(document, volume.file, "/volumes/" + name + "/file"), wish);
  const io::VolumeGrid grid = grid_of(volume, input.volume.head, input.place);
  const auto led = [&](Vec3 p) { return scanner_from_volume(grid, p, input.volume.head.size); };
  input.spacing_m = grid.spacing_m;
  input.attenuation = volume.value == "attenuation";
  input.mesh = believed(document, volume, grid.left_handed(), led);
  for (const manifest::Marker& marker : document.markers)
    if ((marker.volume.empty() || marker.volume == name) && marker.centre_m.size() == 3 && marker.radius_m)
      input.markers.push_back({led({marker.centre_m[0], marker.centre_m[1], marker.centre_m[2]}), *marker.radius_m});
  input.given = switched_on_for(document, "volumes", input.name);
  return input;
}

}  // namespace

bool has_volumes(const manifest::Document& document) {
  return std::ranges::any_of(document.volumes, [&](const auto& v) { return mesh_of(document, v.second) != nullptr; });
}

std::vector<VolumesInput> volumes_inputs(const manifest::Document& document) {
  std::vector<VolumesInput> inputs;
  for (const auto& [name, volume] : document.volumes)
    if (mesh_of(document, volume) != nullptr) inputs.push_back(read_input(document, name, volume));
  return inputs;
}

std::vector<std::filesystem::path> volumes_files(const manifest::Document& document) {
  std::vector<std::filesystem::path> files;
  for (const auto& [name, volume] : document.volumes) {
    const manifest::Mesh* mesh = mesh_of(document, volume);
    if (mesh == nullptr) continue;
    const std::string at = "/volumes/" + name;
    if (!volume.file.empty()) files.push_back(manifest::resolve(document, volume.file, at + "/file"));
    for (const std::string& slice : volume.slices) files.push_back(manifest::resolve(document, slice, at + "/slices"));
    files.push_back(manifest::resolve(document, mesh->file, "/meshes/" + volume.reference + "/file"));
  }
  return files;
}

}  // namespace gonio::explain
