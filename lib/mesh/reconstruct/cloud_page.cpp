#include "mesh/reconstruct/cloud_page.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "mesh/clean.h"
#include "report/mesh_view.h"
#include "report/number_text.h"
#include "report/page.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

constexpr std::size_t most_faces = 60000;  // of a view: what a page bears

std::string millimetres(double m) {
  return report::number_text(1e3 * m, 3);
}

// As the first view's camera sees it; y up in the world, or z where the camera looks along y.
std::array<double, 9> turn_of(const MeasuredPoints& points, Vec3 middle) {
  const Vec3 towards = normalized(points.viewpoints_m[0][0] - middle);
  const Vec3 above = std::abs(towards.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Vec3 right = normalized(cross(above, towards)), up = cross(towards, right);
  return {right.x, right.y, right.z, up.x, up.y, up.z, towards.x, towards.y, towards.z};
}

report::Figure view_of(const report::ViewedMesh& shown, const std::vector<float>& values_m, bool is_signed,
                       const std::array<double, 9>& turn, const char* title, const char* caption) {
  report::MeshView view;
  view.meshes = {shown};
  view.meshes[0].name = title;
  std::vector<double> sizes;
  for (const float v : values_m) {
    view.meshes[0].value.push_back(1e3f * v);
    sizes.push_back(1e3 * std::abs(double{v}));
  }
  view.name = title;
  view.label = is_signed ? "deviation" : "standard deviation", view.unit = "mm";
  view.high = sizes.empty() ? 1 : std::max(1e-9, stats::quantile(sizes, 0.98));
  view.low = is_signed ? -view.high : 0;
  view.turn = turn;
  return {.svg = report::html(view), .title = title, .caption = caption};
}

std::vector<report::Figure> views_of(const MeasuredPoints& points, const Reconstruction& made) {
  io::TriangleMesh mesh = made.mesh;
  std::vector<std::uint32_t> kept(mesh.positions_m.size());
  for (std::uint32_t v = 0; v < kept.size(); ++v) kept[v] = v;
  if (mesh.triangles.size() > most_faces) decimate(mesh, most_faces, &kept);
  report::ViewedMesh shown;
  shown.triangles = mesh.triangles;
  Vec3 middle;
  for (const Vec3 p : mesh.positions_m) {
    middle += p / static_cast<double>(mesh.positions_m.size());
    shown.positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  std::vector<float> sigma, deviation;
  for (const std::uint32_t v : kept) sigma.push_back(made.sigma_m[v]), deviation.push_back(made.deviation_m[v]);
  const std::array<double, 9> turn = turn_of(points, middle);
  return {view_of(shown, sigma, false, turn, "What the mesh states of its own error",
                  "One standard deviation of each vertex along its normal; dark is exact. Turn it by dragging."),
          view_of(shown, deviation, true, turn, "How far the points lie off it",
                  "The mean over the points about each vertex; red where they lie outside, blue inside.")};
}

report::TableText figures_of(const Reconstruction& made, const CloudMeshFigures& figures) {
  report::TableText table{
      .caption = "", .columns = {{"Figure", "", false}, {"Value"}, {"Unit", "", false}}, .rows = {}};
  const auto row = [&](const char* name, std::string value, const char* unit = "") {
    table.rows.push_back({name, std::move(value), unit});
  };
  row("points", std::to_string(figures.points));
  row("usual distance of a point from its sixth neighbour", millimetres(made.spacing_m), "mm");
  row("what neighbouring points scatter by, over what they state", report::number_text(made.noise_ratio, 3));
  row("points off the mesh, root mean square", millimetres(made.deviation.rms_m), "mm");
  row("points off the mesh, half of them at most", millimetres(made.deviation.median_m), "mm");
  row("points off the mesh, 95 % of them at most", millimetres(made.deviation.p95_m), "mm");
  row("the same over what each point states, root mean square", report::number_text(made.deviation.whitened, 3));
  row("points without a surface beside them", std::to_string(made.deviation.bare));
  row("vertices of Poisson's surface", std::to_string(made.poisson_vertices));
  row("cut where points are sparse", std::to_string(made.sparse));
  row("cut where a view saw through", std::to_string(made.seen_through));
  row("cut where a rim turned off", std::to_string(made.contradicting));
  row("small components dropped", std::to_string(made.dropped_components));
  return table;
}

}  // namespace

std::string cloud_page(const MeasuredPoints& points, const Reconstruction& made, const CloudMeshFigures& figures) {
  std::string clouds;
  for (const std::string& one : figures.clouds) clouds += (clouds.empty() ? "" : ", ") + one;
  report::Page page("Mesh " + figures.name,
                    format("%zu vertices in %zu component%s, half of them known to ", made.mesh.positions_m.size(),
                           made.components.size(), made.components.size() == 1 ? "" : "s") +
                        millimetres(figures.sigma_m) + " mm or better.",
                    "From " + clouds + (figures.chain == Chain::gonio ? "." : ", by the thesis's chain."));
  page.section("Mesh");
  page.key_numbers({{"standard deviation", millimetres(figures.sigma_m), "mm", "median of the vertices"},
                    {"points off the mesh", millimetres(made.deviation.rms_m), "mm", "root mean square"},
                    {"over what they state", report::number_text(made.deviation.whitened, 3), "", "1: as stated",
                     made.deviation.whitened > 2 ? report::Tone::bad : report::Tone::neutral}});
  page.figures(views_of(points, made), 560);
  page.table(figures_of(made, figures));
  page.section("Components");
  report::TableText parts{
      .caption = "", .columns = {{"Component"}, {"Vertices"}, {"Triangles"}, {"Area", "cm2"}}, .rows = {}};
  for (std::size_t c = 0; c < made.components.size(); ++c)
    parts.rows.push_back({std::to_string(c + 1), std::to_string(made.components[c].vertices),
                          std::to_string(made.components[c].triangles),
                          report::number_text(1e4 * made.components[c].area_m2, 3)});
  page.table(parts);
  return page.html();
}

}  // namespace gonio::mesh
