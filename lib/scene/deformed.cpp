// See deformed.h.
#include "scene/deformed.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"

namespace gonio::scene {

io::TriangleMesh deformed_mesh(const manifest::Document& document, const std::string& id, double share,
                               const io::PlyWish& wish,
                               const std::function<void(const std::filesystem::path&)>& on_file) {
  const std::string pointer = "/meshes/" + id;
  const manifest::Mesh& entry = document.meshes.at(id);
  const auto path_of = [&](const std::string& file, const std::string& at) {
    const auto path = manifest::resolve(document, file, at);
    if (on_file) on_file(path);
    return path;
  };
  io::TriangleMesh mesh = io::read_ply(path_of(entry.file, pointer + "/file"), wish);
  if (entry.shapes.empty()) return mesh;
  const auto shape = [&](std::size_t k) {
    const std::string at = pointer + "/shapes/" + std::to_string(k);
    std::vector<Vec3> positions_m = io::read_ply(path_of(entry.shapes[k], at)).positions_m;
    if (positions_m.size() != mesh.positions_m.size())
      throw Error(Exit::data, manifest::place(document, at),
                  format("has %zu vertices where the mesh has %zu", positions_m.size(), mesh.positions_m.size()),
                  "shapes are the same vertices at other places");
    return positions_m;
  };
  const double along = share * static_cast<double>(entry.shapes.size() - 1);
  const auto before = static_cast<std::size_t>(along);
  const double part = along - static_cast<double>(before);
  mesh.positions_m = shape(before);
  mesh.normals.clear();
  if (part == 0) return mesh;
  const std::vector<Vec3> after = shape(before + 1);
  for (std::size_t v = 0; v < after.size(); ++v)
    mesh.positions_m[v] = mesh.positions_m[v] + part * (after[v] - mesh.positions_m[v]);
  return mesh;
}

double deformation_of(const manifest::Document& document, const std::string& id, const std::string& image) {
  std::optional<double> share;
  std::string first;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& entry = document.images[i];
    if (!image.empty() && entry.id != image) continue;
    const auto found = entry.shapes.find(id);
    const double here = found == entry.shapes.end() ? 0 : found->second;
    const std::string at = manifest::place(document, "/images/" + std::to_string(i) + "/shapes/" + id);
    if (!(here >= 0 && here <= 1)) throw Error(Exit::data, at, "is " + shortest_text(here), "0 to 1");
    if (share && *share != here)
      throw Error(Exit::data, at,
                  "is " + shortest_text(here) + " where image " + first + " has " + shortest_text(*share) +
                      ": one scene has one shape of it",
                  "take the images one by one");
    if (!share) share = here, first = entry.id;
  }
  return share.value_or(0);
}

}  // namespace gonio::scene
