#include "mesh/reconstruct/cloud_document.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/mesh.h"
#include "mesh/reconstruct/cloud_page.h"
#include "mesh/reconstruct/measured_clouds.h"
#include "mesh/reconstruct/viewpoints.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

using manifest::Document;

constexpr std::size_t least_points = 100;

void write_mesh(const std::filesystem::path& path, const Reconstruction& made) {
  io::PlyWish names{.properties = {"sigma", "deviation"}};
  io::TriangleMesh mesh = made.mesh;
  mesh.properties = {made.sigma_m, made.deviation_m};
  if (!made.colour.empty()) {
    names.properties.insert(names.properties.end(), {"red", "green", "blue"});
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<float>& column = mesh.properties.emplace_back();
      for (const auto& colour : made.colour) column.push_back(colour[k]);
    }
  }
  io::write_ply(path, mesh, names);
}

CloudMeshFigures figures_of(const Reconstruction& made, const CloudMeshRequest& request,
                            const std::vector<std::string>& names) {
  const std::vector<double> sigmas(made.sigma_m.begin(), made.sigma_m.end());
  return {names, request.name, request.wish.chain, stats::median(sigmas), made.deviation.points + made.deviation.bare};
}

void log_mesh(const Reconstruction& made, const CloudMeshFigures& figures) {
  log(LogLevel::info,
      format("%zu view%s, %zu points %.3g mm apart, which scatter by %.3g times what they state", figures.clouds.size(),
             figures.clouds.size() == 1 ? "" : "s", figures.points, 1e3 * made.spacing_m, made.noise_ratio));
  std::string areas;
  for (const MeshComponent& c : made.components) areas += format("%s%.3g", areas.empty() ? "" : " + ", 1e4 * c.area_m2);
  log(LogLevel::info,
      format("mesh %s: %zu vertices in %zu components of %s cm2; %zu smaller ones dropped; of Poisson's %zu vertices "
             "%zu cut where points are sparse, %zu where a view saw through, %zu where a rim turned off",
             figures.name.c_str(), made.mesh.positions_m.size(), made.components.size(), areas.c_str(),
             made.dropped_components, made.poisson_vertices, made.sparse, made.seen_through, made.contradicting));
  const PointDeviation& d = made.deviation;
  log(LogLevel::info,
      format("points lie off it by %.3g mm rms, %.3g mm half of them, %.3g mm 95 %%: %.3g times what they state; %zu "
             "have no surface; its own standard deviation is %.3g mm",
             1e3 * d.rms_m, 1e3 * d.median_m, 1e3 * d.p95_m, d.whitened, d.bare, 1e3 * figures.sigma_m));
}

}  // namespace

void check_cloud_mesh(const Document& document, const CloudMeshRequest& request) {
  const std::vector<std::string> names = chosen_clouds(document, request.clouds, request.viewpoints_m);
  (void)viewpoints_of(document, names, request.viewpoints_m);
  for (const std::string& name : names) {
    const std::filesystem::path path = cloud_path(document, name);
    if (request.note_input) request.note_input(path);
  }
}

CloudMeshSummary cloud_mesh_document(Document& document, const CloudMeshRequest& request) {
  const std::vector<std::string> names = chosen_clouds(document, request.clouds, request.viewpoints_m);
  const MeasuredPoints points = points_of_clouds(document, names, request.viewpoints_m);
  if (points.positions_m.size() < least_points)
    throw Error(Exit::data, manifest::place(document, "/clouds"),
                format("have %zu points together, and a surface takes %zu", points.positions_m.size(), least_points),
                "measure more finely");
  const Reconstruction made = reconstruct(points, request.wish);
  CloudMeshSummary summary{!made.mesh.triangles.empty(), made.deviation.whitened, made.deviation.rms_m,
                           made.noise_ratio};
  if (!summary.surface) return summary;
  const CloudMeshFigures figures = figures_of(made, request, names);
  log_mesh(made, figures);
  const std::string page = request.page.empty() ? std::string() : cloud_page(points, made, figures);
  const auto path = request.output_path(file_stem(request.name) + ".ply");
  write_mesh(path, made);
  if (!request.page.empty()) write_file(request.page, page);
  manifest::Mesh& mesh = document.meshes[request.name];
  mesh = {};
  mesh.file = manifest::add_file(document, path, "mesh-" + request.name);
  mesh.normals = "smooth";
  return summary;
}

}  // namespace gonio::mesh
