// Markers as objects of the scene, and their sightings as the table that explain asks.
#include <algorithm>
#include <cmath>
#include <memory>

#include "base/atomic_file.h"
#include "base/text.h"
#include "camera/camera_model.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/table.h"
#include "manifest/sections/volume.h"
#include "mesh/mesh.h"
#include "mesh/triangle_tree.h"
#include "reassembly/marker_rows.h"
#include "surface/surface.h"
#include "tools/reassemble/work.h"

namespace gonio::tools::reassemble {
namespace {

using reassembly::Outline, reassembly::View;

class Rows {
 public:
  Rows(const Work& work, const PlacedPieces& pieces) : work_(work), pieces_(pieces), posed_(posed(pieces)) {}

  void add(const PlacedPiece& piece, std::size_t marker, std::size_t view, const Outline& outline) {
    const reassembly::PieceMarker& own = piece.piece->markers[marker];
    const View& from = work_.seen.views[view];
    reassembly::MarkerRow row;
    row.image = from.image, row.piece = piece.piece->object, row.marker = own.id;
    row.centre_m = work_.placement.scale * own.centre_m;  // 1 where it was not fitted
    const Mat3& c = own.covariance_m2;
    row.centre_sigma_m = std::sqrt((c(0, 0) + c(1, 1) + c(2, 2)) / 3);
    row.normal = reassembly::outward_normal(piece.mesh, *piece.tree, row.centre_m);
    row.seen_px = outline.centre_px;
    row.sigma_px = sigma_px(view, outline);
    row.glass = reassembly::walls_between(from.world_from_camera.translation_m,
                                          piece.placed->world_from_object * row.centre_m, own.radius_m, posed_);
    rows.push_back(std::move(row));
  }

  // Sightings that bend away are rows as well, where one can tell whose they are: the nearest marker that stands behind
  // glass. Without them nobody could ask whether glass explains them.
  void add_refracted(std::size_t view, const Outline& outline) {
    const View& from = work_.seen.views[view];
    const PlacedPiece* whose = nullptr;
    std::size_t which = 0;
    double nearest = 6 * outline.half_angle_rad;  // three diameters
    for (const auto& piece : pieces_)
      for (std::size_t m = 0; m < piece->piece->markers.size(); ++m) {
        const Vec3 there =
            piece->placed->world_from_object * (work_.placement.scale * piece->piece->markers[m].centre_m);
        const Vec3 seen = normalized(inverse(from.world_from_camera) * there);
        const double angle = std::acos(std::clamp(dot(seen, outline.axis), -1.0, 1.0));
        const auto walls = reassembly::walls_between(from.world_from_camera.translation_m, there,
                                                     piece->piece->markers[m].radius_m, posed_);
        if (angle < nearest && walls[0].path_m > 0) nearest = angle, whose = piece.get(), which = m;
      }
    const auto in_view = [&](const reassembly::MarkerRow& row) {
      return row.image == from.image && row.marker == whose->piece->markers[which].id;
    };
    if (whose != nullptr && std::ranges::none_of(rows, in_view)) add(*whose, which, view, outline);
  }

  std::vector<reassembly::MarkerRow> rows;

 private:
  // The axis' covariance carried into the picture by the camera.
  Vec2 sigma_px(std::size_t view, const Outline& outline) const {
    const manifest::Document& document = work_.call.document;
    const std::size_t image = *manifest::index_of_image(document, work_.seen.views[view].image);
    const camera::CameraModel camera = reassembly::camera_of(document, image);
    const Vec3 across = reassembly::across_of(outline.axis), down = cross(outline.axis, across);
    constexpr double step = 1e-5;
    Vec2 variance{};
    const auto at = camera.project(outline.axis);
    const auto a = camera.project(outline.axis + step * across), b = camera.project(outline.axis + step * down);
    if (!at || !a || !b) return {1, 1};
    const Mat3& c = outline.covariance_rad2;
    const Vec2 da = (*a - *at) * (1 / step), db = (*b - *at) * (1 / step);
    variance.x = da.x * da.x * c(0, 0) + 2 * da.x * db.x * c(0, 1) + db.x * db.x * c(1, 1);
    variance.y = da.y * da.y * c(0, 0) + 2 * da.y * db.y * c(0, 1) + db.y * db.y * c(1, 1);
    return {std::sqrt(variance.x), std::sqrt(variance.y)};
  }

  const Work& work_;
  const PlacedPieces& pieces_;
  std::vector<reassembly::PosedMesh> posed_;
};

// Nothing is seen through what is opaque.
bool light_passes(const Work& work) {
  const manifest::Document& document = work.call.document;
  return std::ranges::any_of(work.placement.pieces, [&](const reassembly::Placed& placed) {
    const auto object = std::ranges::find(document.objects, placed.object, &manifest::Object::id);
    return surface::find(document.surfaces.at(object->surface).model)->transmits();
  });
}

void enter_spheres(Work& work) {
  manifest::Document& document = work.call.document;
  for (const reassembly::Placed& placed : work.placement.pieces) {
    if (placed.verdict != reassembly::Verdict::placed) continue;
    for (const manifest::Marker& marker : document.markers) {
      if (marker.object != placed.object || !marker.radius_m) continue;
      manifest::Mesh sphere;
      sphere.sphere_radius_m = marker.radius_m;
      document.meshes[marker.id] = sphere;
      manifest::Pose<frame::World, frame::Object> pose;
      const Vec3 centre{marker.centre_m[0], marker.centre_m[1], marker.centre_m[2]};
      pose.translation_m = placed.world_from_object * centre;
      std::erase_if(document.objects, [&](const manifest::Object& o) { return o.id == marker.id; });
      document.objects.push_back(
          {.id = marker.id, .mesh = marker.id, .surface = work.asked.marker_surface, .world_from_object = pose});
    }
  }
}

}  // namespace

void enter_markers(Work& work) {
  const auto pieces = placed_pieces(work);
  Rows table(work, pieces);
  for (const auto& piece : pieces)
    for (const reassembly::Pair& pair : piece->placed->pairs)
      for (const reassembly::Sighting& s : work.bundles.found[pair.bundle].sightings)
        table.add(*piece, pair.marker, s.view, work.seen.views[s.view].outlines[s.outline]);
  if (light_passes(work)) {
    for (const BehindGlass& b : work.behind) table.add_refracted(b.view, b.outline);
    for (std::size_t v = 0; v < work.seen.views.size(); ++v)
      for (std::size_t o = 0; o < work.seen.views[v].outlines.size(); ++o)
        if (work.placement.fate[v][o] == reassembly::Fate::refracted)
          table.add_refracted(v, work.seen.views[v].outlines[o]);
  }
  if (!table.rows.empty()) {
    const std::filesystem::path path = work.call.output_path("markers.csv");
    write_file(path, reassembly::marker_csv(table.rows));
    manifest::Document& document = work.call.document;
    document.tables["markers"] = reassembly::marker_table(manifest::add_file(document, path, "markers"));
  }
  if (!work.asked.marker_surface.empty()) enter_spheres(work);
}

}  // namespace gonio::tools::reassemble
