// Step: take the voxels' noise away.
#include <algorithm>

#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

// Positions' own uncertainty at the vertices that carving left where they were; empty where it is not known.
std::vector<double> sigmas(const Work& work) {
  if (work.edges.size() != work.mesh.positions_m.size()) return {};
  std::vector<double> sigma;
  sigma.reserve(work.edges.size());
  for (const volume::Edge& e : work.edges) sigma.push_back((e.good ? e.sigma : 1.0) * work.voxel_m());
  return sigma;
}

void clean_bounded(Work& work) {
  const double within = work.asked.within.metres(work.voxel_m());
  const bool at_edges = work.asked.threshold_by == ThresholdBy::gradient;
  const mesh::BoundedResult result =
      mesh::clean_within(work.mesh, {.within_m = within,
                                     .sigma_m = sigmas(work),
                                     .alike_m = at_edges ? volume::edges_alike_voxels * work.voxel_m() : 0});
  auto& entry = step(work, "clean", "least noise of normals within " + format("%.4g m of the data", within));
  entry.figures = {{"within_m", within},
                   {"rounds", static_cast<double>(result.rounds)},
                   {"rms_move_m", result.rms_move_m},
                   {"largest_move_m", result.largest_move_m},
                   {"at_bound", static_cast<double>(result.at_bound)},
                   {"normal_noise_before_rad", result.normal_noise_before_rad},
                   {"normal_noise_after_rad", result.normal_noise_after_rad}};
}

// As published: to 1 % of the vertices first. With --faces, to the share that ends there: a round of subdivision and
// decimation leaves 0.99 of what it was given.
void clean_by_subdivision(Work& work) {
  mesh::SubdivisionLoop loop;
  const double wanted = 0.5 * static_cast<double>(work.asked.faces);  // vertices
  if (work.asked.faces > 0)
    loop.first = std::min(1.0, wanted / static_cast<double>(std::max<std::size_t>(1, work.mesh.positions_m.size())));
  mesh::clean_by_subdivision(work.mesh, loop);
  step(work, "clean",
       format("decimation to %.3g %% of the vertices, then four times sqrt(3) subdivision and decimation to 33 %%",
              100 * loop.first));
}

}  // namespace

void clean(Work& work) {
  switch (work.asked.clean) {
    case CleanBy::bounded: clean_bounded(work); break;
    case CleanBy::subdivision: clean_by_subdivision(work); break;
    case CleanBy::taubin:
      mesh::smooth_taubin(work.mesh);
      step(work, "clean", "Taubin's lambda | mu smoothing");
      break;
    case CleanBy::none: break;
  }
  work.edges = {};
  if (work.asked.faces > 0 && work.mesh.triangles.size() > work.asked.faces) {
    const std::size_t before = work.mesh.triangles.size(), left = mesh::decimate(work.mesh, work.asked.faces);
    step(work, "decimate", "quadric edge collapse").figures = {{"triangles_before", static_cast<double>(before)},
                                                               {"triangles", static_cast<double>(left)}};
  }
  if (work.asked.clean != CleanBy::none || work.asked.faces > 0) show(work, "cleaned", work.mesh);
}

}  // namespace gonio::tools::ct_mesh_clean
