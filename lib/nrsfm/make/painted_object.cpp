// See painted_object.h.
#include "nrsfm/make/painted_object.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "base/text.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "nrsfm/make/occlusion.h"
#include "nrsfm/make/pictures.h"

namespace gonio::nrsfm {
namespace {

using PathFor = std::function<std::filesystem::path(const std::string&)>;

io::TriangleMesh ply_of(const Eigen::Matrix3Xd& vertices_m,
                        const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  io::TriangleMesh mesh;
  for (Eigen::Index v = 0; v < vertices_m.cols(); ++v)
    mesh.positions_m.push_back({vertices_m(0, v), vertices_m(1, v), vertices_m(2, v)});
  mesh.triangles = triangles;
  return mesh;
}

// The mesh and one file a shape; the first frame bears what else its vertices have.
void enter_mesh(manifest::Document& document, const std::string& id, const Shapes& vertices_m, io::TriangleMesh first,
                const io::PlyWish& properties, const PathFor& path_for) {
  const auto write = [&](const std::string& name, const io::TriangleMesh& mesh, const io::PlyWish& wish) {
    const std::filesystem::path path = path_for(name + ".ply");
    io::write_ply(path, mesh, wish);
    return manifest::add_file(document, path, name);
  };
  manifest::Mesh entry;
  entry.file = write(id, first, properties);
  for (Eigen::Index f = 0; f < vertices_m.rows() / 3; ++f)
    entry.shapes.push_back(
        write(id + format("-%04d", static_cast<int>(f) + 1), ply_of(shape_of(vertices_m, f), first.triangles), {}));
  document.meshes[id] = entry;
}

void enter_object(manifest::Document& document, const std::string& id, const Eigen::Vector3d& place_m) {
  manifest::Object object{.id = id, .mesh = id, .surface = id, .world_from_object = {}};
  object.world_from_object.emplace().translation_m = {place_m.x(), place_m.y(), place_m.z()};
  std::erase_if(document.objects, [&id](const manifest::Object& there) { return there.id == id; });
  document.objects.push_back(object);
}

double longest_edge_m(const DeformingSurface& surface) {
  double longest = 0;
  for (const auto& t : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      longest =
          std::max(longest, (surface.vertices_m.col(t[k]) - surface.vertices_m.col(t[(k + 1) % 3])).head<3>().norm());
  return longest;
}

Shapes rig_vertices(const std::vector<Rig>& rig, FrameMesh& first) {
  Shapes vertices;
  for (std::size_t f = 0; f < rig.size(); ++f) {
    FrameMesh mesh;
    mesh.vertices_m.resize(3, 0);
    for (const RigBox& box : rig[f]) add_box(mesh, box);
    if (f == 0) vertices.resize(3 * static_cast<Eigen::Index>(rig.size()), mesh.vertices_m.cols());
    shape_of(vertices, static_cast<Eigen::Index>(f)) = mesh.vertices_m;
    if (f == 0) first = std::move(mesh);
  }
  return vertices;
}

Extent extent_of(const Shapes& surface, const Shapes& rig) {
  Extent all{Eigen::Vector3d::Constant(1e300), Eigen::Vector3d::Constant(-1e300)};
  for (const Shapes* shapes : {&surface, &rig})
    for (Eigen::Index f = 0; f < shapes->rows() / 3; ++f) {
      all.lower_m = all.lower_m.cwiseMin(shape_of(*shapes, f).rowwise().minCoeff());
      all.upper_m = all.upper_m.cwiseMax(shape_of(*shapes, f).rowwise().maxCoeff());
    }
  return all;
}

}  // namespace

// A corner belongs to all triangles that share it, a place on an edge to both that share the edge: keys are (lower end,
// upper end, how far), places inside a triangle its own.
Refined refined(const std::vector<std::array<std::uint32_t, 3>>& triangles, int parts) {
  Refined out;
  std::map<std::tuple<std::uint32_t, std::uint32_t, int>, std::uint32_t> on_edges;
  const auto vertex_on = [&](std::uint32_t a, std::uint32_t b, int along, const Anchor& anchor) {
    const auto key = along == 0       ? std::tuple(a, a, 0)
                     : along == parts ? std::tuple(b, b, 0)
                     : a < b          ? std::tuple(a, b, along)
                                      : std::tuple(b, a, parts - along);
    const auto [found, is_new] = on_edges.try_emplace(key, static_cast<std::uint32_t>(out.vertices.size()));
    if (is_new) out.vertices.push_back(anchor);
    return found->second;
  };
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    std::map<std::pair<int, int>, std::uint32_t> at;  // i parts towards b, j towards c
    for (int j = 0; j <= parts; ++j)
      for (int i = 0; i + j <= parts; ++i) {
        const Anchor anchor{t, static_cast<double>(i) / parts, static_cast<double>(j) / parts};
        if (j == 0)
          at[{i, j}] = vertex_on(a, b, i, anchor);
        else if (i == 0)
          at[{i, j}] = vertex_on(a, c, j, anchor);
        else if (i + j == parts)
          at[{i, j}] = vertex_on(b, c, j, anchor);
        else
          at[{i, j}] = static_cast<std::uint32_t>(out.vertices.size()), out.vertices.push_back(anchor);
      }
    for (int j = 0; j < parts; ++j)
      for (int i = 0; i + j < parts; ++i) {
        out.triangles.push_back({at[{i, j}], at[{i + 1, j}], at[{i, j + 1}]});
        if (i + j + 1 < parts) out.triangles.push_back({at[{i + 1, j}], at[{i + 1, j + 1}], at[{i, j + 1}]});
      }
  }
  return out;
}

Extent enter_painted(manifest::Document& document, const DeformingSurface& surface, const std::string& id,
                     const PaintOptions& options, const PathFor& path_for) {
  // Between two values of the paint's lattice two vertices.
  const int parts = std::max(1, static_cast<int>(std::ceil(2 * longest_edge_m(surface) / options.grain_m)));
  Refined fine = refined(surface.triangles, parts);
  DeformingSurface cut = surface;
  cut.anchors = std::move(fine.vertices);
  const Shapes vertices = anchored(cut);
  io::TriangleMesh first = ply_of(shape_of(vertices, 0), fine.triangles);
  const Paint paint{options.grain_m, options.seed};
  first.properties.emplace_back();
  for (Eigen::Index v = 0; v < vertices.cols(); ++v)
    first.properties[0].push_back(static_cast<float>(albedo(paint, shape_of(vertices, 0).col(v))));
  enter_mesh(document, id, vertices, first, {.properties = {"paint"}}, path_for);
  manifest::Surface painted;
  painted.vertices["albedo"] = "paint";
  document.surfaces[id] = painted;

  FrameMesh boxes;
  const Shapes rig = rig_vertices(surface.rig, boxes);
  Extent all = extent_of(vertices, rig);
  const Eigen::Vector3d middle = (all.lower_m + all.upper_m) / 2, place(-middle.x(), -middle.y(), -all.lower_m.z());
  enter_object(document, id, place);
  if (!surface.rig.empty()) {
    enter_mesh(document, id + "-rig", rig, ply_of(shape_of(rig, 0), boxes.triangles), {}, path_for);
    document.meshes[id + "-rig"].normals = "flat";
    document.surfaces[id + "-rig"] = {};
    document.surfaces[id + "-rig"].parameters["albedo"] = std::vector<double>{0.2, 0.2, 0.2};
    enter_object(document, id + "-rig", place);
  }
  all.lower_m += place, all.upper_m += place;
  return all;
}

}  // namespace gonio::nrsfm
