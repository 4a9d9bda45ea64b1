// See volumes_problem.h: from the manifest to a volume and a mesh in the scanner's frame.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/volumes/volumes_problem.h"
#include "io/ply.h"
#include "linear/solve.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/volume.h"
#include "mechanism/mechanism.h"

namespace gonio::explain {
namespace {

using Matrix4 = Eigen::Matrix4d;

const manifest::Mesh* mesh_of(const manifest::Document& document, const manifest::Volume& volume) {
  const auto found = document.meshes.find(volume.mesh);
  return found == document.meshes.end() || found->second.file.empty() ? nullptr : &found->second;
}

// metres from indices: what the manifest says, else the file.
Matrix4 volume_from_index(const manifest::Volume& volume, const io::VolumeHead& head, const std::string& place) {
  Matrix4 m = Matrix4::Identity();
  if (volume.volume_from_index) {
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) m(r, c) = volume.volume_from_index->matrix.at(static_cast<std::size_t>(4 * r + c));
    return m;
  }
  if (!head.spacing_m)
    throw Error(Exit::data, place, "says no voxel size, and neither does its file", "give spacing_m or volume_from_index");
  const Vec3 spacing = *head.spacing_m, origin = head.origin_m.value_or(Vec3{});
  const Mat3 axes = head.axes.value_or(Mat3{});
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) m(r, c) = axes(r, c) * spacing[c];
    m(r, 3) = origin[r];
  }
  return m;
}

// The object's place in the frame that volume_from_index leads to, where an object has the mesh.
Rigid<frame::World, frame::Object> pose_of(const manifest::Document& document, const std::string& mesh) {
  for (const manifest::Object& object : document.objects)
    if (object.mesh == mesh && object.world_from_object) return *object.world_from_object;
  return {};
}

struct Frame {
  Matrix4 scanner_from_volume;
  Vec3 spacing_m;
};
Frame frame_of(const Matrix4& m, const std::array<std::size_t, 3>& size, const std::string& place) {
  Frame frame;
  double spacing[3];
  for (int a = 0; a < 3; ++a) spacing[a] = m.col(a).head<3>().norm();
  frame.spacing_m = {spacing[0], spacing[1], spacing[2]};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < a; ++b)
      if (!(std::abs(m.col(a).head<3>().dot(m.col(b).head<3>())) < 1e-3 * spacing[a] * spacing[b]))
        throw Error(Exit::data, place, "has axes that are not at right angles", "resample it onto a straight grid");
  Matrix4 scale = Matrix4::Identity(), middle = Matrix4::Identity();
  for (int a = 0; a < 3; ++a) {
    scale(a, a) = spacing[a];
    middle(a, 3) = -0.5 * (static_cast<double>(size[static_cast<std::size_t>(a)]) - 1);
  }
  frame.scanner_from_volume = scale * middle * linear::inverse(m);
  return frame;
}

Vec3 led(const Matrix4& m, Vec3 p) {
  const Eigen::Vector4d q = m * Eigen::Vector4d(p.x, p.y, p.z, 1);
  return {q[0], q[1], q[2]};
}

mesh::Mesh believed(const manifest::Document& document, const manifest::Volume& volume, const Matrix4& scanner_from_volume) {
  const manifest::Mesh* entry = mesh_of(document, volume);
  const std::string at = "/meshes/" + volume.mesh + "/file";
  io::TriangleMesh raw = io::read_ply(manifest::resolve(document, entry->file, at));
  raw.normals.clear();
  mesh::Mesh mesh = mesh::prepare(std::move(raw), mesh::Shading::smooth, manifest::place(document, at));
  const Rigid<frame::World, frame::Object> pose = pose_of(document, volume.mesh);
  for (Vec3& p : mesh.positions_m) p = led(scanner_from_volume, pose * p);
  if (scanner_from_volume.topLeftCorner<3, 3>().determinant() < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  mesh.normals = mesh::averaged_normals(mesh.positions_m, mesh.triangles);
  return mesh;
}

VolumesInput read_input(const manifest::Document& document, const std::string& name, const manifest::Volume& volume) {
  VolumesInput input;
  input.name = name, input.mesh_name = volume.mesh;
  input.place = manifest::place(document, "/volumes/" + name);
  if (volume.file.empty()) throw Error(Exit::data, input.place, "names no file", "give the volume: \"file\": id");
  io::VolumeWish wish;
  if (volume.spacing_m.size() == 3) wish.spacing_m = Vec3{volume.spacing_m[0], volume.spacing_m[1], volume.spacing_m[2]};
  if (volume.tiles.size() == 2)
    wish.tiles = {static_cast<std::size_t>(volume.tiles[0]), static_cast<std::size_t>(volume.tiles[1])};
  input.volume = io::read_volume(manifest::resolve(document, volume.file, "/volumes/" + name + "/file"), wish);
  const Frame frame = frame_of(volume_from_index(volume, input.volume.head, input.place), input.volume.head.size, input.place);
  input.spacing_m = frame.spacing_m;
  input.attenuation = volume.value == "attenuation";
  input.mesh = believed(document, volume, frame.scanner_from_volume);
  for (const manifest::Marker& marker : document.markers)
    if ((marker.volume.empty() || marker.volume == name) && marker.centre_m.size() == 3 && marker.radius_m)
      input.markers.push_back({led(frame.scanner_from_volume, {marker.centre_m[0], marker.centre_m[1], marker.centre_m[2]}),
                               *marker.radius_m});
  for (const auto& [id, use] : document.mechanisms) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    if (m == nullptr || std::ranges::find(m->domains, "volumes") == m->domains.end()) continue;
    const auto on = std::ranges::find(use.on, name);
    if (!use.on.empty() && on == use.on.end()) continue;
    manifest::Parameters& own = input.given[id];
    for (const auto& [key, parameter] : use.parameters) {
      const auto at = static_cast<std::size_t>(on - use.on.begin());
      if (parameter.given()) own[key] = manifest::Parameter(parameter.value[std::min(at, parameter.value.size() - 1)]);
    }
  }
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
    files.push_back(manifest::resolve(document, mesh->file, "/meshes/" + volume.mesh + "/file"));
  }
  return files;
}

}  // namespace gonio::explain
