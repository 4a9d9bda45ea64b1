// What the table model "markers" takes from the manifest: cameras where the photographs have them, pieces where the
// objects stand, each with the numbers by which it may stand otherwise.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "explain/tables/image_views.h"
#include "explain/tables/table_model.h"
#include "geom/rigid.h"
#include "manifest/pose.h"
#include "reassembly/marker_rows.h"
#include "scene/scene.h"

namespace gonio::explain::tables {

using MarkerView = ImageView;
struct MarkerPiece {
  std::string object;
  // Its shape is no more than the box of its mesh: what geometry.pose turns it about. Without a mesh, its origin.
  scene::Instance instance;
  bool estimated = false;  // the manifest states the pose's sigma: it is free in the base model
};
struct Sighting {
  std::size_t view = 0, piece = 0, marker = 0;
  Vec3 centre_m, normal;
  double centre_sigma_m = 0;
  bool has_normal = false, behind_glass = false;
  std::array<reassembly::GlassWall, reassembly::most_walls> glass{};
};
struct MarkerScene {
  std::vector<MarkerView> views;
  std::vector<MarkerPiece> pieces;
  std::vector<std::string> markers;  // "id", in the order of their first rows
  std::vector<Sighting> rows;        // as the table's
};
// Error(data) at the table for images, objects, cameras and poses that the manifest does not have.
MarkerScene marker_scene(const manifest::Document& document, const Table& table);

// The sigmas of a pose, which the manifest states at the object's origin, from those of geometry.pose's numbers, whose
// turn is about the middle of its box.
manifest::PoseSigma sigma_at_origin(const scene::Instance& instance, Vec3 shift_m, Vec3 turn_rad);

}  // namespace gonio::explain::tables
