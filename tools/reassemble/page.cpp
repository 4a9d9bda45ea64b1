// The page: which pieces stand where and how surely, what the photographs show, what each marker says.
#include "report/page.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "manifest/sections/object.h"
#include "manifest/sections/placement.h"
#include "mesh/clean.h"
#include "report/mesh_view.h"
#include "report/number_text.h"
#include "tools/reassemble/draw.h"

namespace gonio::tools::reassemble {
namespace {

using reassembly::Verdict;
using report::number_text;

constexpr std::size_t viewed_faces = 30000;  // of each mesh: a page stays below some megabytes
constexpr std::size_t shown_views = 12;

std::size_t placed_count(const Work& work) {
  return static_cast<std::size_t>(
      std::ranges::count(work.placement.pieces, Verdict::placed, &reassembly::Placed::verdict));
}

std::string headline(const Work& work) {
  const std::size_t all = work.pieces.size(), placed = placed_count(work);
  if (placed == all && work.complaints.empty())
    return all == 1   ? "The piece stands where the photographs show its markers"
           : all == 2 ? "Both pieces stand where the photographs show their markers"
                      : format("All %zu pieces stand where the photographs show their markers", all);
  if (placed == all) return "Every piece has a place, but: " + work.complaints.front();
  return format("%zu of %zu pieces could be placed", placed, all);
}

double largest(const std::vector<double>& v) {
  return v.empty() ? 0 : *std::ranges::max_element(v);
}

void pieces_table(report::Page& page, const Work& work) {
  page.section("Pieces");
  report::TableText table;
  table.columns = {{"Piece", "", false}, {"Verdict", "", false}, {"Markers", ""},         {"Distance, rms", "mm"},
                   {"expected", "mm"},   {"Place", "sigma, mm"}, {"Turn", "sigma, mrad"}, {"chi-square", "per degree"}};
  std::vector<std::string> why;
  for (const manifest::Placement& p : work.call.document.placements) {
    const bool stands = p.world_from_object.has_value() && p.world_from_object->sigma.has_value();
    const auto mm = [](std::optional<double> v) { return v ? number_text(1e3 * *v, 3) : std::string("–"); };
    table.rows.push_back(
        {p.object, p.verdict,
         std::to_string(p.pairs.size()) + " of " + std::to_string(p.pairs.size() + p.unseen.size()), mm(p.rms_m),
         mm(p.expected_m), stands ? number_text(1e3 * largest(p.world_from_object->sigma->translation_m), 2) : "–",
         stands ? number_text(1e3 * largest(p.world_from_object->sigma->rotation_rad), 2) : "–",
         p.chi_square && p.degrees.value_or(0) > 0 ? number_text(*p.chi_square / *p.degrees, 3) : "–"});
    if (!p.why.empty()) why.push_back(p.object + ": " + p.why);
  }
  page.table(table);
  why.insert(why.end(), work.ties.begin(), work.ties.end());
  if (!why.empty()) page.list(why);
  if (work.placement.sigma_scale > 0)
    page.paragraph("Scale of the tomograph: " + report::with_sigma(work.placement.scale, work.placement.sigma_scale) +
                   ".");
  page.note(
      "Distance: between where the photographs put a marker and where the placed piece has it; expected: what the "
      "uncertainties of both let expect. The pose's whole covariance stands in the manifest (placements).");
}

void photographs(report::Page& page, const Work& work) {
  page.section("Photographs");
  page.paragraph(
      "Blue circles: markers of placed pieces. Green: spheres that several views agree on, of no piece. Orange, "
      "dashed: "
      "disagrees with the other views, as what is seen through glass, is partly hidden, or is no sphere. Purple, "
      "dotted: "
      "mirrored. Grey: seen by one view only. Crosses: where the placed pieces have their markers, on this side or the "
      "other.");
  std::vector<report::Figure> figures;
  for (std::size_t v = 0; v < work.seen.views.size() && v < shown_views; ++v) {
    const std::vector<Look> looks = looks_of(work, v);
    figures.push_back({.svg = drawing_of(work, v),
                       .title = work.seen.views[v].image,
                       .caption = format("%zu outlines, %td paired, %td disagree, %zu refused", looks.size(),
                                         std::ranges::count(looks, Look::paired),
                                         std::ranges::count(looks, Look::refracted), work.seen.refused[v].size())});
  }
  page.figures(figures, 520);
  if (work.seen.views.size() > shown_views)
    page.note(format("The first %zu of %zu are shown.", shown_views, work.seen.views.size()));
}

void marker_tables(report::Page& page, const Work& work) {
  page.section("Markers");
  report::TableText table;
  table.columns = {{"Marker", "", false}, {"Photographs", ""}, {"Distance", "mm"},
                   {"expected", "mm"},    {"Residual", "px"},  {"Without it the piece moves", "mm"}};
  std::string mover;
  double most = 0;
  for (const manifest::Placement& p : work.call.document.placements) {
    for (const manifest::MarkerPair& m : p.pairs) {
      table.rows.push_back({m.marker, std::to_string(m.images.size()), number_text(1e3 * m.residual_m.value_or(0), 3),
                            number_text(1e3 * m.expected_m.value_or(0), 3), number_text(m.residual_px.value_or(0), 3),
                            number_text(1e3 * m.moves_m.value_or(0), 3)});
      if (m.moves_m.value_or(0) > most) most = *m.moves_m, mover = m.marker;
    }
    for (const std::string& m : p.unseen) table.rows.push_back({m, "0", "–", "–", "–", "–"});
  }
  page.table(table);
  if (!mover.empty())
    page.paragraph("The answer hangs most on " + mover + ": without it its piece would stand " +
                   number_text(1e3 * most, 2) + " mm elsewhere.");
}

report::ViewedMesh viewed(const std::string& name, io::TriangleMesh mesh) {
  mesh::decimate(mesh, viewed_faces);
  report::ViewedMesh out{.name = name, .positions = {}, .triangles = mesh.triangles, .value = {}};
  for (const Vec3& p : mesh.positions_m)
    out.positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  return out;
}

void scene(report::Page& page, const Work& work) {
  report::ViewedMesh all{.name = "scene", .positions = {}, .triangles = {}, .value = {}};
  const auto append = [&](const report::ViewedMesh& part) {
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
    for (const auto& t : part.triangles) all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  };
  for (const reassembly::Placed& placed : work.placement.pieces)
    if (placed.verdict == Verdict::placed) append(viewed(placed.object, placed_mesh(work, placed.object)));
  if (!work.background.triangles.empty()) append(viewed("background", work.background));
  if (all.triangles.empty()) return;
  report::MeshView view{.name = "the scene", .meshes = {std::move(all)}, .label = "", .unit = ""};
  page.section("The scene");
  page.figures({{.svg = report::html(view),
                 .title = "",
                 .caption = "Drag to turn, wheel or + and - to come nearer, shift-drag to move."}},
               640);
}

void contacts(report::Page& page, const Work& work) {
  if (work.contacts.empty()) return;
  page.section("Contact");
  report::TableText table;
  table.columns = {{"Piece", "", false}, {"Against", "", false}, {"How", "", false}, {"What happened", "", false}};
  for (const ContactNote& note : work.contacts) table.rows.push_back({note.piece, note.other, note.how, note.words});
  page.table(table);
}

void labels(report::Page& page, const Work& work) {
  if (work.label_pictures.empty()) return;
  page.section("Surfaces of the background");
  double sure = 0;
  for (const float c : work.label_confidence) sure += c;
  if (!work.label_confidence.empty()) sure /= static_cast<double>(work.label_confidence.size());
  page.paragraph(
      format("%zu faces at borders were split; %zu faces were seen by no view and took the nearest label; mean "
             "confidence %.1f %%.",
             work.split_faces, work.unseen_faces, 100 * sure));
  std::vector<report::Figure> figures;
  for (const LabelledView& view : work.label_pictures) {
    figures.push_back({.png = view.labels_png, .title = view.image + ": labels"});
    figures.push_back({.png = view.confidence_png, .title = view.image + ": confidence, dark is unsure"});
  }
  page.figures(figures, 420);
}

}  // namespace

std::string page(const Work& work) {
  const bool good = work.complaints.empty();
  report::Page page(
      "reassemble", headline(work),
      format("%zu photographs, %zu pieces, %zu spheres on which views agree, %zu of them of no piece.",
             work.seen.views.size(), work.pieces.size(), work.bundles.found.size(), work.placement.left_over.size()),
      good ? report::Tone::good : report::Tone::bad);
  if (!good) page.list(work.complaints);
  pieces_table(page, work);
  photographs(page, work);
  scene(page, work);
  contacts(page, work);
  labels(page, work);
  marker_tables(page, work);
  return page.html();
}

}  // namespace gonio::tools::reassemble
