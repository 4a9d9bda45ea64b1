// Sightings of markers as a table, one row for each marker of a piece in each photograph: what `reassemble` writes and
// what the table model "markers" of `explain` reads (lib/explain/tables/models/markers.cpp). Both take the columns from
// here.
//
// A row says where the tomograph has the marker in its piece's frame, which way the piece's surface faces there, where
// the photograph shows it, and what glass stands between. The cameras and their poses are the manifest's images, the
// pieces' poses its objects. Metres, unit vectors, pixels.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "geom/vector.h"
#include "manifest/sections/table.h"
#include "mesh/mesh.h"
#include "mesh/triangle_tree.h"

namespace gonio::reassembly {

// One wall of glass that the straight line from the camera to the marker goes through.
struct GlassWall {
  double path_m = 0;    // within the glass; 0: no wall
  double behind_m = 0;  // from where the line leaves the glass to the marker's centre
  Vec3 in, out;         // unit normals of the wall's surface where the line goes in and out, world frame, pointing out
                        // of the glass
};
constexpr std::size_t most_walls = 2;  // the two that bend a ray most: farthest from the marker

struct MarkerRow {
  std::string image, piece, marker;  // ids in the manifest's images, objects, markers
  Vec3 centre_m;                     // of the marker in the object's frame, by the tomograph
  double centre_sigma_m = 0;         // one standard deviation of each coordinate; 0: known exactly
  Vec3 normal;                       // outward unit normal of the piece where its surface is nearest, object frame;
                                     // zero: not known
  Vec2 seen_px, sigma_px;            // Outline::centre_px: where the axis of the marker's cone meets the picture
  std::array<GlassWall, most_walls> glass{};
};

struct MarkerColumn {
  std::string name, unit, meaning;
  bool needed = true;  // by the model
};
const std::vector<MarkerColumn>& marker_columns();
std::string glass_column(std::size_t wall, const std::string& what);  // (0, "path_m"): "glass_path_m"; 1: "glass2_..."

std::string marker_csv(std::span<const MarkerRow> rows);  // with its header line
// The manifest's section for it: model, columns with units, observed, sigma, group. `file`: id in the manifest's files.
manifest::Table marker_table(const std::string& file);

// What a row needs to know of the pieces' meshes.
struct PosedMesh {
  const mesh::Mesh* mesh = nullptr;  // of glass, closed, facing outwards
  const mesh::TriangleTree* tree = nullptr;
  Rigid<frame::World, frame::Object> world_from_object;
};
// Normal of the triangle nearest to `point_m`, object frame.
Vec3 outward_normal(const mesh::Mesh& mesh, const mesh::TriangleTree& tree, Vec3 point_m);
// The walls between a camera and a marker, world frame, from the camera on. A marker touches the wall that it is glued
// to: what the line crosses within `radius_m` of the centre is left out.
std::array<GlassWall, most_walls> walls_between(Vec3 camera_m, Vec3 marker_m, double radius_m,
                                                std::span<const PosedMesh> meshes);

}  // namespace gonio::reassembly
