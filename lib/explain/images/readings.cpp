// See readings.h: the list, and what each does to a scene.
#include "explain/images/readings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "geom/mat3_inverse.h"

namespace gonio::explain::images {
namespace {

using MeshOf = std::shared_ptr<const mesh::Mesh>;

struct Unit {
  double scale;
  const char* fault;
  const char* said;
};
constexpr std::array<Unit, 10> mesh_units = {{{0.001, "to be in millimetres", "0.001"},
                                              {0.01, "to be in centimetres", "0.01"},
                                              {0.0254, "to be in inches", "0.0254"},
                                              {0.1, "to be ten times too large", "0.1"},
                                              {1 / 25.4, "to be 25.4 times too large", "1/25.4"},
                                              {10, "to be ten times too small", "10"},
                                              {25.4, "to be 25.4 times too small", "25.4"},
                                              {1 / 0.0254, "to be 39.37 times too small", "39.37"},
                                              {100, "to be a hundred times too small", "100"},
                                              {1000, "to be a thousand times too small", "1000"}}};

struct Turn {
  Mat3 meant_from_file;
  const char* fault;
  const char* remedy;
};
constexpr std::array<Turn, 11> mesh_turns = {
    {{{{-1, 0, 0, 0, 1, 0, 0, 0, 1}}, "to be mirrored in x", "with x negated"},
     {{{1, 0, 0, 0, -1, 0, 0, 0, 1}}, "to be mirrored in y", "with y negated"},
     {{{1, 0, 0, 0, 1, 0, 0, 0, -1}}, "to be mirrored in z", "with z negated"},
     {{{1, 0, 0, 0, 0, -1, 0, 1, 0}}, "to have y up where z is", "turned by 90 degrees about x"},
     {{{1, 0, 0, 0, 0, 1, 0, -1, 0}}, "to have z up where y is", "turned by -90 degrees about x"},
     {{{0, 0, 1, 0, 1, 0, -1, 0, 0}}, "to be turned about y", "turned by 90 degrees about y"},
     {{{0, 0, -1, 0, 1, 0, 1, 0, 0}}, "to be turned about y", "turned by -90 degrees about y"},
     {{{0, 1, 0, 1, 0, 0, 0, 0, 1}}, "to have the axes x and y exchanged", "with x and y exchanged"},
     {{{0, 0, 1, 0, 1, 0, 1, 0, 0}}, "to have the axes x and z exchanged", "with x and z exchanged"},
     {{{1, 0, 0, 0, 0, 1, 0, 1, 0}}, "to have the axes y and z exchanged", "with y and z exchanged"},
     {{{1, 0, 0, 0, -1, 0, 0, 0, -1}}, "to be upside down", "turned by 180 degrees about x"}}};

Mat3 scaled_by(double s) {
  return {{s, 0, 0, 0, s, 0, 0, 0, s}};
}

double determinant(const Mat3& a) {
  return a(0, 0) * (a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1)) - a(0, 1) * (a(1, 0) * a(2, 2) - a(1, 2) * a(2, 0)) +
         a(0, 2) * (a(1, 0) * a(2, 1) - a(1, 1) * a(2, 0));
}

// Vertices times `m`; a mirror keeps what is outside outside.
MeshOf changed(const mesh::Mesh& mesh, const Mat3& m) {
  auto meant = std::make_shared<mesh::Mesh>(mesh);
  const double turned = determinant(m) < 0 ? -1 : 1;
  const Mat3 of_normals = transposed(inverse(m));
  for (Vec3& p : meant->positions_m) p = m * p;
  for (Vec3& n : meant->normals) n = normalized(of_normals * n);
  if (turned < 0)
    for (auto& t : meant->triangles) std::swap(t[1], t[2]);
  return meant;
}

void add_mesh_readings(const std::string& subject, bool plural, const std::vector<std::size_t>& instances,
                       std::vector<Reading>& all) {
  for (const Unit& unit : mesh_units)
    all.push_back({.subject = subject,
                   .fault = unit.fault,
                   .remedy = std::string("scaled by ") + unit.said,
                   .plural = plural,
                   .instances = instances,
                   .meant_from_file = scaled_by(unit.scale)});
  for (const Turn& turn : mesh_turns)
    all.push_back({.subject = subject,
                   .fault = turn.fault,
                   .remedy = turn.remedy,
                   .plural = plural,
                   .instances = instances,
                   .meant_from_file = turn.meant_from_file});
}

void add_place_readings(std::vector<Reading>& all) {
  for (const Unit& unit : mesh_units) {
    const std::string remedy = std::string("scaled by ") + unit.said;
    all.push_back({.subject = "places of the cameras",
                   .fault = unit.fault,
                   .remedy = remedy,
                   .plural = true,
                   .cameras_scale = unit.scale});
    all.push_back({.subject = "places of cameras and lamps",
                   .fault = unit.fault,
                   .remedy = remedy,
                   .plural = true,
                   .cameras_scale = unit.scale,
                   .lamps_scale = unit.scale});
  }
}

void add_picture_readings(std::vector<Reading>& all) {
  const Reading pose{.subject = "poses", .plural = true, .of_pictures = true};
  const Reading picture{.subject = "pictures", .plural = true, .of_pictures = true};
  Reading r = pose;
  r.inverted = true, r.fault = "to be camera_from_world, not world_from_camera", r.remedy = "inverted";
  all.push_back(r);
  r = pose;
  r.looks_back = true, r.fault = "to be of a camera that has y up and looks along -z",
  r.remedy = "turned by 180 degrees about the camera's x";
  all.push_back(r);
  r.inverted = true, r.fault = "to be camera_from_world of a camera that has y up and looks along -z",
  r.remedy = "inverted and turned by 180 degrees about the camera's x";
  all.push_back(r);
  r = picture;
  r.left_right = true, r.fault = "to be flipped left to right", r.remedy = "flipped back";
  all.push_back(r);
  r = picture;
  r.upside_down = true, r.fault = "to be upside down", r.remedy = "with their rows in the other order";
  all.push_back(r);
  r.left_right = true, r.fault = "to be turned by half a turn", r.remedy = "turned back";
  all.push_back(r);
}

}  // namespace

std::vector<Reading> readings_of(const scene::Scene& scene) {
  std::vector<Reading> all;
  add_picture_readings(all);
  std::vector<std::pair<MeshOf, std::vector<std::size_t>>> meshes;  // and who shows them
  std::vector<std::size_t> whole;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const auto* mesh = std::get_if<MeshOf>(&scene.instances[i].shape);
    if (mesh == nullptr) continue;
    whole.push_back(i);
    const auto known = std::ranges::find(meshes, *mesh, [](const auto& m) { return m.first; });
    if (known == meshes.end())
      meshes.push_back({*mesh, {i}});
    else
      known->second.push_back(i);
  }
  if (meshes.size() > 1) add_mesh_readings("meshes", true, whole, all);
  for (const auto& [mesh, instances] : meshes) {
    std::string names;
    for (const std::size_t i : instances) names += (names.empty() ? "`" : " and `") + scene.instances[i].id + "`";
    add_mesh_readings("mesh of " + names, false, instances, all);
  }
  add_place_readings(all);
  return all;
}

std::vector<scene::Instance> meant(const scene::Scene& scene, const Reading& reading) {
  std::vector<scene::Instance> instances = scene.instances;
  std::vector<std::pair<MeshOf, MeshOf>> done;
  for (const std::size_t i : reading.instances) {
    const MeshOf file = std::get<MeshOf>(instances[i].shape);
    auto known = std::ranges::find(done, file, [](const auto& d) { return d.first; });
    if (known == done.end()) {
      done.push_back({file, changed(*file, reading.meant_from_file)});
      known = std::prev(done.end());
    }
    instances[i].shape = known->second;
  }
  return instances;
}

View meant(const View& view, const Reading& reading) {
  View meant = view;
  auto& pose = meant.world_from_camera;
  if (reading.inverted) {
    const auto other = inverse(pose);
    pose = {other.rotation, other.translation_m};
  }
  if (reading.looks_back) pose.rotation = normalized(pose.rotation * Quaternion{0, 1, 0, 0});
  pose.translation_m = pose.translation_m * reading.cameras_scale;
  return meant;
}

LightSource meant(const LightSource& lamp, const Reading& reading) {
  LightSource meant = lamp;
  meant.position_m = meant.position_m * reading.lamps_scale;
  return meant;
}

}  // namespace gonio::explain::images
