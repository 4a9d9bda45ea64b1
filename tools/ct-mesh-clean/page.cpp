// The report: what was made, the slices, the surfaces to turn, where the cleaned mesh differs, the histogram, the
// steps.
#include "report/page.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "mesh/clean.h"
#include "mesh/verdict.h"
#include "report/mesh_view.h"
#include "report/number_text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

constexpr std::size_t viewed_faces = 30000;  // of each surface: a page stays below some megabytes

double figure(const Work& work, const char* step, const char* name) {
  for (const manifest::VolumeStep& s : work.steps)
    if (s.name == step)
      if (const auto found = s.figures.find(name); found != s.figures.end()) return found->second;
  return 0;
}

// What a page can hold of the mesh: with which of its vertices.
struct Shown {
  io::TriangleMesh mesh;
  std::vector<std::uint32_t> kept;
};
Shown shown_of(io::TriangleMesh mesh) {
  Shown shown{std::move(mesh), {}};
  mesh::decimate(shown.mesh, viewed_faces, &shown.kept);
  return shown;
}

report::ViewedMesh viewed(const std::string& name, const std::vector<Vec3>& positions_m,
                          const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  report::ViewedMesh out{.name = name, .positions = {}, .triangles = triangles, .value = {}};
  for (const Vec3& p : positions_m)
    out.positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  return out;
}

// Earlier stages of the same triangles are shown with those that are shown of the last, so that the difference is the
// surface's alone.
report::ViewedMesh viewed(const Stage& stage, const Work& work, const Shown& last) {
  if (stage.triangles != work.mesh.triangles || stage.positions_m.size() != work.mesh.positions_m.size()) {
    io::TriangleMesh own;
    own.positions_m = stage.positions_m, own.triangles = stage.triangles;
    own = shown_of(std::move(own)).mesh;
    return viewed(stage.name, own.positions_m, own.triangles);
  }
  std::vector<Vec3> positions;
  positions.reserve(last.kept.size());
  for (const std::uint32_t v : last.kept) positions.push_back(stage.positions_m[v]);
  return viewed(stage.name, positions, last.mesh.triangles);
}

void stages(report::Page& page, const Work& work, const Shown& last) {
  report::MeshView view{.name = work.name, .meshes = {}, .label = "", .unit = ""};
  for (auto stage = work.stages.rbegin(); stage != work.stages.rend(); ++stage)
    view.meshes.push_back(viewed(*stage, work, last));
  page.section("The surface, step by step");
  page.figures({{.svg = report::html(view),
                 .title = "",
                 .caption = "Drag to turn, wheel or + and - to come nearer, shift-drag to move. Shown with at most " +
                            std::to_string(viewed_faces) + " triangles."}},
               640);
}

void deviation(report::Page& page, const Work& work, const Shown& last) {
  const double voxel = work.voxel_m();
  report::ViewedMesh coloured = viewed("deviation", last.mesh.positions_m, last.mesh.triangles);
  for (const double d : mesh::signed_distances(last.mesh.positions_m, work.data))
    coloured.value.push_back(static_cast<float>(d / voxel));
  std::vector<float> sizes;
  for (const float v : coloured.value) sizes.push_back(std::abs(v));
  double full = 0.1;
  if (!sizes.empty()) {
    const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), at, sizes.end());
    full = std::max(1e-3, static_cast<double>(*at));
  }
  report::MeshView view{.name = work.name + ", deviation from the data",
                        .meshes = {std::move(coloured)},
                        .label = "outwards from where the data put the surface",
                        .unit = "voxel",
                        .low = -full,
                        .high = full};
  page.section("Where the mesh leaves the data");
  page.figures({{.svg = report::html(view), .title = "", .caption = ""}}, 640);
}

void histogram(report::Page& page, const Work& work) {
  const volume::Histogram& h = work.look.histogram;
  report::Plot plot{.title = "Values", .x_label = "value", .y_label = "voxels"};
  constexpr std::size_t shown = 256;
  const std::size_t group = std::max<std::size_t>(1, h.counts.size() / shown);
  const double bin = (h.high - h.low) / static_cast<double>(std::max<std::size_t>(1, h.counts.size()));
  report::Series bars{.kind = report::Series::Kind::line, .name = "voxels"};
  for (std::size_t b = 0; b + group <= h.counts.size(); b += group) {
    double count = 0;
    for (std::size_t i = b; i < b + group; ++i) count += static_cast<double>(h.counts[i]);
    bars.x.push_back(h.low + (static_cast<double>(b) + 0.5 * static_cast<double>(group)) * bin);
    bars.y.push_back(count);
  }
  plot.series = {bars};
  plot.log_y = true;
  plot.marks.push_back({report::Mark::Axis::x, work.threshold.value, "threshold"});
  if (figure(work, "markers", "found") > 0)
    plot.marks.push_back({report::Mark::Axis::x, figure(work, "markers", "threshold"), "markers"});
  page.section("Values");
  page.plot(plot);
}

void steps(report::Page& page, const Work& work) {
  page.section("Steps");
  report::TableText table;
  table.columns = {{"Step", "", false}, {"What", "", false}, {"Figures", "", false}};
  for (const manifest::VolumeStep& s : work.steps) {
    std::string figures;
    for (const auto& [name, value] : s.figures)
      figures += (figures.empty() ? "" : ", ") + name + " " + report::number_text(value, 4);
    table.rows.push_back({s.name, s.how, figures});
  }
  page.table(table);
}

void marker_table(report::Page& page, const Work& work) {
  if (work.markers.found.empty() && work.markers.refused.empty()) return;
  page.section("Markers");
  report::TableText table;
  table.columns = {{"Marker", "", false},         {"x", "mm"},        {"y", "mm"},   {"z", "mm"}, {"radius", "mm"},
                   {"sigma of the centre", "um"}, {"residual", "um"}, {"cover", "%"}};
  for (std::size_t i = 0; i < work.markers.found.size(); ++i) {
    const volume::Marker& m = work.markers.found[i];
    const Vec3 c = work.grid.metres(m.centre) * 1e3;
    const double sigma = std::sqrt(std::max({m.covariance[0], m.covariance[4], m.covariance[8]})) * work.voxel_m();
    table.rows.push_back({work.name + "-" + std::to_string(i + 1), format("%.4f", c.x), format("%.4f", c.y),
                          format("%.4f", c.z), format("%.4f", m.radius * work.voxel_m() * 1e3),
                          format("%.2f", sigma * 1e6), format("%.2f", m.rms_residual * work.voxel_m() * 1e6),
                          format("%.0f", 100 * m.cover)});
  }
  page.table(table);
  std::vector<std::string> refused;
  for (const volume::RefusedMarker& r : work.markers.refused)
    refused.push_back(
        format("at voxel %.1f, %.1f, %.1f, radius %.2f voxels: ", r.centre.x, r.centre.y, r.centre.z, r.radius) +
        r.why);
  if (!refused.empty()) {
    page.subsection("Refused");
    page.list(refused);
  }
}

}  // namespace

std::string page(const Work& work) {
  const double voxel = work.voxel_m(), bend = figure(work, "verdict", "ray_bend_rms_rad");
  const std::string headline = !work.sound   ? "The mesh is not fit to be rendered as glass."
                               : work.missed ? "The mesh is sound, and misses a limit."
                                             : "The mesh is sound: closed, 2-manifold, free of self-intersections.";
  report::Page page("ct-mesh-clean", headline, work.steps.empty() ? "" : work.path + ": " + work.steps.front().how,
                    work.missed ? report::Tone::bad : report::Tone::good);
  page.key_numbers({{"triangles", std::to_string(work.mesh.triangles.size()), "", ""},
                    {"distance to the data", format("%.3f", figure(work, "verdict", "distance_rms_m") / voxel), "voxel",
                     "root mean square"},
                    {"noise of normals", format("%.2f", figure(work, "verdict", "normal_noise_rad") * 180 / pi), "deg",
                     "root mean square"},
                    {"rays are bent wrongly by", format("%.2f", bend * 180 / pi), "deg",
                     format("refractive index %.3g", work.asked.index)},
                    {"genus", format("%.0f", figure(work, "verdict", "genus")), "", ""}});
  page.section("Slices");
  std::vector<report::Figure> slices;
  for (const StepPicture& p : work.pictures) slices.push_back({.png = p.png, .title = p.title, .caption = p.caption});
  page.figures(slices, 300);
  const Shown last = shown_of(work.mesh);
  stages(page, work, last);
  deviation(page, work, last);
  marker_table(page, work);
  histogram(page, work);
  steps(page, work);
  return page.html();
}

}  // namespace gonio::tools::ct_mesh_clean
