// Step: spheres glued to the object.
#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

// Half-way between the object and the densest material, which is the markers'.
double marker_threshold(const Work& work) {
  if (work.asked.marker_threshold) return *work.asked.marker_threshold;
  const auto& materials = work.look.mixture.materials;
  if (object_material(work) == work.look.air || object_material(work) + 1 >= materials.size())
    throw Error(Exit::data, work.path, "shows no material denser than the object: none is the markers'",
                "give --marker-threshold VALUE");
  return 0.5 * (materials[object_material(work)].mean + materials.back().mean);
}

}  // namespace

void find_markers(Work& work) {
  if (!work.asked.find_markers || !work.markers.found.empty()) return;  // the threshold may have asked already
  const double threshold = marker_threshold(work);
  if (threshold >= work.look.histogram.largest)
    throw Error(Exit::data, work.path,
                format("no value is above the markers' threshold of %.6g: the largest is %.6g", threshold,
                       work.look.histogram.largest),
                "give a lower --marker-threshold");
  const volume::Contour surface =
      volume::contour(*work.file, {.threshold = threshold, .inside = volume::Connectivity::twenty_six});
  volume::MarkerWish wish{.seed = work.call.seed};  // the noise within the markers is not that of the air
  wish.scale = work.grid.spacing_m / work.voxel_m();
  if (work.asked.marker_radius_m) wish.radius = *work.asked.marker_radius_m / work.voxel_m();
  work.markers = volume::markers(*work.file, surface, threshold, wish);
  work.markers_mesh = in_metres(work, surface);
  double worst = 0;
  for (const volume::Marker& m : work.markers.found) worst = std::max(worst, m.rms_residual);
  auto& entry = step(work, "markers",
                     std::to_string(work.markers.found.size()) + " spheres found, " +
                         std::to_string(work.markers.refused.size()) + " refused" +
                         (work.markers.refused.empty() ? "" : "; the first " + work.markers.refused.front().why));
  entry.figures = {{"threshold", threshold},
                   {"found", static_cast<double>(work.markers.found.size())},
                   {"refused", static_cast<double>(work.markers.refused.size())},
                   {"worst_residual_m", worst * work.voxel_m()}};
  if (work.markers.found.empty())
    throw Error(Exit::data, work.path,
                work.markers.refused.empty() ? "shows no sphere above a value of " + format("%.6g", threshold)
                                             : "shows no marker: " + work.markers.refused.front().why,
                "check --markers and --marker-threshold, or leave --markers out");
}

void carve(Work& work) {
  if (work.markers.found.empty()) return;
  std::vector<mesh::CarvedSphere> spheres;
  for (const volume::Marker& m : work.markers.found)
    spheres.push_back({work.grid.metres(m.centre), m.radius * work.voxel_m()});
  work.carved = mesh::carve(work.mesh, spheres, work.asked.eps, work.path);
  double worst = 0;
  for (const mesh::FilledHole& h : work.carved.holes) worst = std::max(worst, h.uncertainty_m);
  auto& entry = step(work, "carve",
                     std::to_string(work.carved.holes.size()) + " holes filled within " +
                         format("%.3g", 1 + work.asked.eps) + " radii of the markers");
  entry.figures = {{"holes", static_cast<double>(work.carved.holes.size())},
                   {"removed_triangles", static_cast<double>(work.carved.removed_triangles)},
                   {"untouched_markers", static_cast<double>(work.carved.untouched.size())},
                   {"worst_fill_sigma_m", worst}};
  show(work, "carved", work.mesh);
}

}  // namespace gonio::tools::ct_mesh_clean
