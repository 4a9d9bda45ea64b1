#include "mesh/reconstruct/cloud_document.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/mesh.h"
#include "mesh/reconstruct/cloud_page.h"
#include "mesh/reconstruct/cloud_points.h"
#include "mesh/reconstruct/viewpoints.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

using manifest::Document;

constexpr std::size_t least_points = 100;

std::vector<std::string> chosen(const Document& document, const CloudMeshRequest& request) {
  std::vector<std::string> names = request.clouds;
  if (names.empty())
    for (const auto& [name, cloud] : document.clouds) names.push_back(name);
  if (names.empty())
    throw Error(Exit::no_input, manifest::place(document, "/clouds"), "has none", "structured-light measures them");
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!document.clouds.contains(names[k]))
      throw Error(Exit::usage, "--view", names[k] + " is none of the manifest's clouds",
                  "leave it out: all of them are taken");
    if (std::ranges::count(names, names[k]) > 1)
      throw Error(Exit::usage, "--view", names[k] + " is given twice", "name every cloud once");
  }
  for (const auto& [name, at] : request.viewpoints_m)
    if (std::ranges::find(names, name) == names.end())
      throw Error(Exit::usage, "--viewpoint", name + " is none of the clouds that are taken", "see --view");
  return names;
}

MeasuredPoints points_of(const Document& document, const CloudMeshRequest& request,
                         const std::vector<std::string>& names) {
  MeasuredPoints points;
  points.viewpoints_m = viewpoints_of(document, names, request.viewpoints_m);
  bool coloured = true;
  for (std::uint32_t v = 0; v < names.size(); ++v) {
    const auto path = manifest::resolve(document, document.clouds.at(names[v]).file, "/clouds/" + names[v] + "/file");
    read_points(path, v, points);
    coloured = coloured && points.colour.size() == points.positions_m.size();
    for (std::size_t i = points.view.size(); i > 0 && points.view[i - 1] == v; --i)
      for (const Vec3 from : points.viewpoints_m[v])
        if (!(norm(points.positions_m[i - 1] - from) > 0))
          throw Error(Exit::data, path.string(), format("point %zu lies at a viewpoint of its cloud", i - 1),
                      "--viewpoint states another one");
  }
  if (!coloured) points.colour.clear();
  if (points.positions_m.size() < least_points)
    throw Error(Exit::data, manifest::place(document, "/clouds"),
                format("have %zu points together, and a surface takes %zu", points.positions_m.size(), least_points),
                "measure more finely");
  return points;
}

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
  log(LogLevel::info, format("%zu views, %zu points %.3g mm apart, which scatter by %.3g times what they state",
                             figures.clouds.size(), figures.points, 1e3 * made.spacing_m, made.noise_ratio));
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
  const std::vector<std::string> names = chosen(document, request);
  (void)viewpoints_of(document, names, request.viewpoints_m);
  for (const std::string& name : names) {
    const auto path = manifest::resolve(document, document.clouds.at(name).file, "/clouds/" + name + "/file");
    if (request.note_input) request.note_input(path);
  }
}

CloudMeshSummary cloud_mesh_document(Document& document, const CloudMeshRequest& request) {
  const std::vector<std::string> names = chosen(document, request);
  const MeasuredPoints points = points_of(document, request, names);
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
