// Step: the surface, and where asked its vertices at the steepest gradient.
#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {

void contour(Work& work) {
  work.contour = volume::contour(*work.volume, {.threshold = work.threshold.value, .inside = work.asked.inside});
  auto& entry = step(work, "surface", "dual contouring on crossings and gradients");
  entry.figures = {{"vertices", static_cast<double>(work.contour.positions.size())},
                   {"triangles", static_cast<double>(work.contour.triangles.size())},
                   {"split_polygons", static_cast<double>(work.contour.split_polygons)},
                   {"shared_cells", static_cast<double>(work.contour.shared_cells)}};
  if (work.threshold.sigma > 0) {  // what a threshold that is wrong by its sigma does to a wall, and to a length
    work.threshold.voxels_per_value = volume::voxels_per_value(work.look.histogram, work.contour, work.threshold.value,
                                                               work.grid.spacing_m / work.voxel_m());
    entry.figures["sigma_wall_m"] = work.threshold.sigma_wall_voxels() * work.voxel_m();
    entry.figures["sigma_length_m"] = 2 * work.threshold.sigma_wall_voxels() * work.voxel_m();
  }
  if (work.with_page) show(work, "contour", in_metres(work, work.contour));
}

void refine(Work& work) {
  auto& entry = work.steps.back();
  const Vec3 scale = work.grid.spacing_m / work.voxel_m();
  work.edges =
      volume::edges(*work.volume, work.contour,
                    {.noise = work.look.noise_air, .noise_correlation = work.look.noise_correlation, .scale = scale});
  const volume::LocalThreshold local = volume::local_threshold(work.threshold, work.edges);
  entry.figures["edges"] = static_cast<double>(local.edges);
  entry.figures["wall_bias_m"] = local.wall_bias * work.voxel_m();  // what a global threshold does
  entry.figures["wall_rms_m"] = local.wall_rms * work.voxel_m();
  if (work.asked.threshold_by == ThresholdBy::gradient) {
    const volume::Refined refined = volume::move_to_steepest(work.contour, work.edges, 1.5, scale);
    auto& moved = step(work, "steepest", "vertices moved to the steepest gradient along their normals");
    moved.figures = {{"moved", static_cast<double>(refined.moved)},
                     {"held", static_cast<double>(refined.held)},
                     {"unfitted", static_cast<double>(refined.unfitted)},
                     {"mean_shift_m", refined.mean_shift * work.voxel_m()},
                     {"rms_shift_m", refined.rms_shift * work.voxel_m()},
                     {"largest_shift_m", refined.largest_shift * work.voxel_m()},
                     {"sigma_position_m", refined.sigma_position * work.voxel_m()}};
  }
  work.data = in_metres(work, work.contour);
  work.contour = {};
  work.mesh = work.data;
  if (work.asked.threshold_by == ThresholdBy::gradient) show(work, "steepest gradient", work.data);
}

}  // namespace gonio::tools::ct_mesh_clean
