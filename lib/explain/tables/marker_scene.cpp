// See marker_scene.h.
#include "explain/tables/marker_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/volume.h"
#include "scene/placement.h"

namespace gonio::mechanism {
const Mechanism& geometry_pose();
}

namespace gonio::explain::tables {
namespace {

// Two corners have the same box as the mesh.
scene::Shape box_of(const manifest::Document& document, const manifest::Object& object) {
  const auto entry = document.meshes.find(object.mesh);
  if (entry == document.meshes.end() || entry->second.file.empty()) return scene::Sphere{};
  const auto path = manifest::resolve(document, entry->second.file, "/meshes/" + object.mesh + "/file");
  if (!std::filesystem::exists(path)) return scene::Sphere{};
  const io::TriangleMesh mesh = io::read_ply(path);
  if (mesh.positions_m.empty()) return scene::Sphere{};
  Vec3 lower = mesh.positions_m[0], upper = lower;
  for (const Vec3& p : mesh.positions_m) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  auto box = std::make_shared<mesh::Mesh>();
  box->positions_m = {lower, upper};
  return box;
}

MarkerPiece piece_of(const manifest::Document& document, const std::string& id, const Table& table) {
  for (const manifest::Object& object : document.objects) {
    if (object.id != id) continue;
    MarkerPiece piece{id, {}, false};
    piece.instance.id = id;
    piece.instance.shape = box_of(document, object);
    if (object.world_from_object) {
      piece.instance.world_from_object = *object.world_from_object;
      piece.estimated = object.world_from_object->sigma.has_value();
    }
    return piece;
  }
  throw Error(Exit::data, table.place, "has markers of piece \"" + id + "\", which the manifest does not have",
              "enter it in objects, with its world_from_object");
}

double cell(const Table& table, const std::string& column, std::size_t row) {
  const std::vector<double>* values = table.find(column);
  return values == nullptr ? 0 : (*values)[row];
}
Vec3 vector_in(const Table& table, const std::string& stem, std::size_t row) {
  return {cell(table, stem + "_x", row), cell(table, stem + "_y", row), cell(table, stem + "_z", row)};
}

Sighting sighting_in(const Table& table, std::size_t row) {
  Sighting s;
  s.centre_m = {cell(table, "x_m", row), cell(table, "y_m", row), cell(table, "z_m", row)};
  s.centre_sigma_m = cell(table, "centre_sigma_m", row);
  s.normal = {cell(table, "nx", row), cell(table, "ny", row), cell(table, "nz", row)};
  s.has_normal = norm(s.normal) > 0.5;
  for (std::size_t w = 0; w < s.glass.size(); ++w) {
    const auto at = [&](const char* what) { return reassembly::glass_column(w, what); };
    s.glass[w] = {cell(table, at("path_m"), row), cell(table, at("behind_m"), row), vector_in(table, at("in"), row),
                  vector_in(table, at("out"), row)};
    s.behind_glass = s.behind_glass || s.glass[w].path_m > 0;
  }
  return s;
}

template <class List>
std::vector<std::string> ids_of(const List& list) {
  std::vector<std::string> ids;
  for (const auto& entry : list) ids.push_back(entry.id);
  return ids;
}

}  // namespace

MarkerScene marker_scene(const manifest::Document& document, const Table& table) {
  for (const reassembly::MarkerColumn& column : reassembly::marker_columns())
    if (column.needed || table.place_of(column.name) != Table::none) table.needed(column.name, column.unit);
  const Names images = names_in(table, "image", manifest::names_in(document, "images"));
  const Names pieces = names_in(table, "piece", ids_of(document.objects));
  const Names markers = names_in(table, "marker", ids_of(document.markers));
  MarkerScene scene;
  for (const std::string& id : images.all) scene.views.push_back(image_view(document, id, table));
  for (const std::string& id : pieces.all) scene.pieces.push_back(piece_of(document, id, table));
  scene.markers = markers.all;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    Sighting s = sighting_in(table, r);
    s.view = images.of_row[r], s.piece = pieces.of_row[r], s.marker = markers.of_row[r];
    scene.rows.push_back(s);
  }
  std::vector<std::size_t> piece_of_marker(markers.all.size(), Table::none);
  for (const Sighting& s : scene.rows) {
    std::size_t& piece = piece_of_marker[s.marker];
    if (piece == Table::none) piece = s.piece;
    if (piece != s.piece)
      throw Error(Exit::data, table.place,
                  "has marker \"" + scene.markers[s.marker] + "\" on \"" + scene.pieces[piece].object + "\" and on \"" +
                      scene.pieces[s.piece].object + "\"",
                  "call each marker by a name of its own");
  }
  return scene;
}

manifest::PoseSigma sigma_at_origin(const scene::Instance& instance, Vec3 shift_m, Vec3 turn_rad) {
  // Half turns take the origin to the other end of twice its arm.
  const auto by = [&](std::array<double, 6> numbers) {
    const Vec3 to = scene::moved(instance, mechanism::geometry_pose(), numbers).world_from_object.translation_m;
    return (instance.world_from_object.translation_m - to) * 0.5;
  };
  const Vec3 about_x = by({0, 0, 0, pi, 0, 0}), about_y = by({0, 0, 0, 0, pi, 0});
  const Vec3 arm{about_y.x, about_x.y, about_x.z};
  return {{turn_rad.x, turn_rad.y, turn_rad.z},
          {std::hypot(shift_m.x, turn_rad.y * arm.z, turn_rad.z * arm.y),
           std::hypot(shift_m.y, turn_rad.z * arm.x, turn_rad.x * arm.z),
           std::hypot(shift_m.z, turn_rad.x * arm.y, turn_rad.y * arm.x)}};
}

}  // namespace gonio::explain::tables
