// Meshes on the platform: read, looked at, set down, structured; and small pictures of them.
#include <algorithm>
#include <cmath>

#include "base/assignment.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/lower_case.h"
#include "base/progress.h"
#include "base/text.h"
#include "contrast/measure/matrix_code.h"
#include "io/codes.h"
#include "io/obj.h"
#include "io/raster.h"
#include "manifest/sections/file.h"
#include "manifest/sections/mesh.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "print/mend.h"
#include "relief/microstructure_use.h"
#include "tools/dlp-slice/work.h"

namespace gonio::tools::dlp_slice {
namespace {

double unit_m(const std::string& unit) {
  return unit == "mm" ? 1e-3 : unit == "um" ? 1e-6 : unit == "in" ? 0.0254 : 1;
}

io::TriangleMesh read_mesh(Work& work, const std::filesystem::path& path) {
  work.call.note_input(path);
  const std::string extension = lower_case(path.extension().string());
  io::TriangleMesh mesh =
      extension == ".ply" ? io::read_ply(path, {.properties = {}, .labels = true}) : io::read_mesh(path);
  const bool metres = extension == ".ply" || extension == ".3mf";  // the latter once its own unit is read
  if (!metres && !work.call.given("unit"))
    throw Error(Exit::usage, "--unit", "is missing: " + path.filename().string() + " does not say what its numbers are",
                "add, say, --unit mm");
  const double scale = (metres ? 1 : unit_m(work.call.text("unit"))) * work.call.number("scale");
  for (Vec3& p : mesh.positions_m) p = p * scale;
  return mesh;
}

// Corners that stand at the same place are one, triangles without an edge of length gone: what seams of files leave.
void weld(io::TriangleMesh& mesh) {
  const std::vector<std::uint32_t> first = mesh::welded(mesh.positions_m);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto [a, b, c] = mesh.triangles[t];
    if (mesh.texture.empty()) a = first[a], b = first[b], c = first[c];
    if (first[a] == first[b] || first[b] == first[c] || first[c] == first[a]) continue;
    if (!mesh.labels.empty()) mesh.labels[kept] = mesh.labels[t];
    mesh.triangles[kept++] = {a, b, c};
  }
  mesh.triangles.resize(kept);
  if (!mesh.labels.empty()) mesh.labels.resize(kept);
}

mesh::Topology topology_of(const io::TriangleMesh& mesh) {
  mesh::Mesh of;
  of.positions_m = mesh.positions_m, of.triangles = mesh.triangles;
  return mesh::topology_of(of);
}

// A sound mesh with labels or texture coordinates keeps them; others are made fit to be sliced, or refused.
io::TriangleMesh sound(Work& work, io::TriangleMesh mesh, const std::string& place, manifest::PrintedPart& part) {
  const bool more = !mesh.labels.empty() || !mesh.texture.empty();
  if (more) {
    weld(mesh);
    const mesh::Topology topology = topology_of(mesh);
    if (!mesh.triangles.empty() && topology.closed() && topology.crowded_edges == 0 && topology.volume_m3 > 0) {
      part.volume_m3 = topology.volume_m3;
      return mesh;
    }
    log(LogLevel::warning, place + ": is not sound; its labels and texture coordinates are lost as it is mended");
  }
  const double largest = work.call.given("largest-hole") ? work.call.number("largest-hole") : 0;
  print::Mended mended = print::mend(std::move(mesh), {.largest_hole_m = largest}, place);
  for (const std::string& step : mended.steps) log(LogLevel::info, place + ": " + step);
  part.repaired = mended.steps, part.volume_m3 = mended.volume_m3;
  return std::move(mended.mesh);
}

struct Placing {
  Vec2 at{};
  double turn_rad = 0;
};

void turn(io::TriangleMesh& mesh, double rad) {
  const double c = std::cos(rad), s = std::sin(rad);
  if (rad == 0) return;
  for (Vec3& p : mesh.positions_m) p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

struct Extent {
  Vec3 low, high;
};
Extent extent_of(const io::TriangleMesh& mesh) {
  Extent e{mesh.positions_m[mesh.triangles[0][0]], mesh.positions_m[mesh.triangles[0][0]]};
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) {
      const Vec3& p = mesh.positions_m[v];
      e.low = {std::min(e.low.x, p.x), std::min(e.low.y, p.y), std::min(e.low.z, p.z)};
      e.high = {std::max(e.high.x, p.x), std::max(e.high.y, p.y), std::max(e.high.z, p.z)};
    }
  return e;
}

std::vector<Placing> placings(const cli::Invocation& call, const std::vector<Extent>& extents) {
  const std::size_t n = extents.size();
  const std::vector<std::string>& at = call.texts("at");
  if (!at.empty() && at.size() != n)
    throw Error(Exit::usage, "--at",
                "is given " + std::to_string(at.size()) + " times for " + std::to_string(n) + " meshes",
                "give it once for each, or not at all");
  std::vector<Placing> all(n);
  double wide = 0;
  for (const Extent& e : extents) wide += e.high.x - e.low.x;
  wide += call.number("gap") * static_cast<double>(n - 1);
  double x = -wide / 2;
  for (std::size_t i = 0; i < n; ++i) {
    const double half = (extents[i].high.x - extents[i].low.x) / 2;
    if (at.empty()) {
      all[i].at = {x + half, 0};
      x += 2 * half + call.number("gap");
      continue;
    }
    const std::vector<double> xy = lengths_of(at[i], 2, "--at");
    all[i].at = {xy[0], xy[1]};
  }
  return all;
}

std::vector<double> turns(const cli::Invocation& call, std::size_t n) {
  std::vector<double> all;
  for (const std::string& text : call.texts("turn")) all.push_back(parse_quantity(text, Dimension::angle, "--turn"));
  if (!all.empty() && all.size() != n)
    throw Error(Exit::usage, "--turn",
                "is given " + std::to_string(all.size()) + " times for " + std::to_string(n) + " meshes",
                "give it once for each, or not at all");
  all.resize(n, 0);
  return all;
}

void add_areas(const print::SlicedBody& body, manifest::PrintedPart& part) {
  double facing = 0, hidden = 0;
  for (const auto& [a, b, c] : body.triangles) {
    const Vec3 twice = cross(body.positions_m[b] - body.positions_m[a], body.positions_m[c] - body.positions_m[a]);
    (twice.z > 0 ? facing : twice.z < 0 ? hidden : facing) += twice.z == 0 ? 0 : norm(twice) / 2;
  }
  part.facing_m2 = facing, part.hidden_m2 = hidden;
}

void enter(Work& work, const std::string& name, const io::TriangleMesh& mesh) {
  const std::filesystem::path path = work.call.output_path(name + ".ply");
  io::write_ply(path, mesh, {.properties = {}, .labels = !mesh.labels.empty()});
  work.call.document.meshes[name] = manifest::Mesh{.file = manifest::add_file(work.call.document, path, name),
                                                   .sphere_radius_m = {},
                                                   .plane_size_m = {},
                                                   .normals = "smooth"};
}

std::string free_name(const std::vector<manifest::PrintedPart>& parts, const std::string& stem) {
  const auto taken = [&](const std::string& name) {
    return std::ranges::any_of(parts, [&](const manifest::PrintedPart& p) { return p.mesh == name; });
  };
  std::string name = stem;
  for (int k = 2; taken(name); ++k) name = stem + "-" + std::to_string(k);
  return name;
}

// The data matrix of --code, a pixel a cell, as the file "code".
void draw_code(Work& work) {
  if (!work.call.given("code")) return;
  const contrast::MatrixCode code = contrast::write_matrix(work.call.text("code"), 0, 0, "--code");
  io::Image image(code.modules.columns, code.modules.rows, {"Y"});
  std::copy(code.modules.bits.begin(), code.modules.bits.end(), image.data.begin());
  const std::filesystem::path path = work.call.output_path("code.png");
  io::write_png(path, image, 8);
  work.call.document.files.erase("code");
  manifest::add_file(work.call.document, path, "code");
}

struct AskedStructure {
  manifest::MicrostructureUse use;
  std::string name, part;
  std::optional<std::int32_t> label;
};

std::vector<AskedStructure> structures_asked(Work& work) {
  std::vector<AskedStructure> all;
  for (const std::string& text : work.call.texts("structure")) {
    AskedStructure asked;
    asked.use =
        relief::parse_microstructure(text, "--structure", [&](const std::string& name, const std::string& value) {
          if (name == "on") asked.part = value;
          if (name == "label")
            asked.label = static_cast<std::int32_t>(std::lround(parse_quantity(value, Dimension::none, "--structure")));
          return name == "on" || name == "label";
        });
    if (!asked.use.file.empty() && !work.call.document.files.contains(asked.use.file)) {
      const std::string path = asked.use.file;
      if (!std::filesystem::exists(path))
        throw Error(Exit::no_input, path, "is neither a file of the manifest nor one that is there",
                    "name a picture: file=FILE");
      work.call.note_input(path);
      asked.use.file =
          manifest::add_file(work.call.document, path, file_stem(std::filesystem::path(path).stem().string()));
    }
    auto& structures = work.entry().microstructures;
    asked.name = asked.use.model;
    for (int k = 2; structures.contains(asked.name); ++k) asked.name = asked.use.model + "-" + std::to_string(k);
    structures[asked.name] = asked.use;
    all.push_back(std::move(asked));
  }
  return all;
}

void add_structures(Work& work) {
  draw_code(work);
  const std::string axes = work.call.text("axes");
  const Vec3 direction = direction_of(work.call);
  std::vector<manifest::PrintedPart>& parts = work.entry().parts;
  for (const AskedStructure& asked : structures_asked(work)) {
    const relief::ShareAt share = relief::structure_of(work.call.document, asked.use, work.printer.layer_m,
                                                       work.printer.place + "/microstructures/" + asked.name);
    bool used = false;
    for (std::size_t i = 0; i < work.bodies.size(); ++i) {
      if (!asked.part.empty() && parts[i].mesh != asked.part) continue;
      print::SlicedBody& body = work.bodies[i];
      if (asked.label && std::ranges::find(body.labels, *asked.label) == body.labels.end()) continue;
      used = true;
      if (asked.label)
        body.by_label[*asked.label] = share, parts[i].labels[std::to_string(*asked.label)] = asked.name;
      else
        body.structure = share, parts[i].microstructure = asked.name;
    }
    if (!used)
      throw Error(Exit::usage, "--structure",
                  asked.name + " applies to no mesh" + (asked.label ? " with that label" : ""),
                  "on= takes a mesh's name, label= a label of its faces");
  }
  for (print::SlicedBody& body : work.bodies) {
    body.axes = axes == "texture"     ? print::StructureAxes::texture
                : axes == "faces"     ? print::StructureAxes::faces
                : axes == "direction" ? print::StructureAxes::direction
                                      : print::StructureAxes::platform;
    body.direction = direction;
    body.texture_m = work.call.number("texture-length"), body.structured_beneath = work.call.flag("beneath");
  }
}

}  // namespace

void open_bodies(Work& work) {
  const std::vector<std::string>& files = work.call.texts("MESH");
  const std::vector<double> turned = turns(work.call, files.size());
  std::vector<io::TriangleMesh> meshes;
  std::vector<io::TriangleMesh>& meshes_to_write = work.meshes;
  std::vector<Extent> extents;
  std::vector<manifest::PrintedPart>& parts = work.entry().parts;
  parts.clear(), work.entry().microstructures.clear();
  for (std::size_t i = 0; i < files.size(); ++i) {
    manifest::PrintedPart part;
    io::TriangleMesh mesh = sound(work, read_mesh(work, files[i]), files[i], part);
    part.mesh = free_name(parts, file_stem(std::filesystem::path(files[i]).stem().string()));
    meshes_to_write.push_back(mesh);
    turn(mesh, turned[i]);
    part.turn_rad = turned[i];
    extents.push_back(extent_of(mesh)), meshes.push_back(std::move(mesh)), parts.push_back(std::move(part));
  }
  const std::vector<Placing> places = placings(work.call, extents);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const Extent& e = extents[i];
    const Vec3 move{places[i].at.x - (e.low.x + e.high.x) / 2, places[i].at.y - (e.low.y + e.high.y) / 2, -e.low.z};
    for (Vec3& p : meshes[i].positions_m) p = p + move;
    parts[i].at_m = {move.x, move.y, move.z};
    print::SlicedBody body;
    body.name = files[i], body.positions_m = std::move(meshes[i].positions_m),
    body.triangles = std::move(meshes[i].triangles);
    body.texture = std::move(meshes[i].texture), body.labels = std::move(meshes[i].labels);
    print::snap_to_layers(body, work.printer, 0);
    add_areas(body, parts[i]);
    work.bodies.push_back(std::move(body));
  }
  add_structures(work);
  if (work.call.flag("beneath"))
    for (manifest::PrintedPart& part : parts)
      if (!part.microstructure.empty() || !part.labels.empty()) part.hidden_printed_m2 = part.hidden_m2;
}

void enter_bodies(Work& work) {
  const std::vector<manifest::PrintedPart>& parts = work.entry().parts;
  for (std::size_t i = 0; i < parts.size(); ++i) enter(work, parts[i].mesh, work.meshes[i]);
}

report::MeshView view_of(std::string name, std::span<const Vec3> positions_m,
                         std::vector<std::array<std::uint32_t, 3>> triangles) {
  report::ViewedMesh mesh{.name = name, .positions = {}, .triangles = std::move(triangles), .value = {}};
  for (const Vec3& p : positions_m)
    mesh.positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  report::MeshView view;
  view.name = std::move(name);
  view.meshes.push_back(std::move(mesh));
  view.turn = {0.866, -0.5, 0, 0.25, 0.433, 0.866, -0.433, -0.75, 0.5};
  return view;
}

report::MeshView view_of(const Work& work) {
  std::vector<Vec3> positions_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const print::SlicedBody& body : work.bodies) {
    const auto first = static_cast<std::uint32_t>(positions_m.size());
    positions_m.insert(positions_m.end(), body.positions_m.begin(), body.positions_m.end());
    for (const auto& [a, b, c] : body.triangles) triangles.push_back({a + first, b + first, c + first});
  }
  return view_of("what stands on the platform", positions_m, std::move(triangles));
}

std::vector<print::JobPreview> previews_of(const Work& work) {
  const report::MeshView view = view_of(work);
  std::vector<print::JobPreview> previews;
  for (const auto& [wide, high] : {std::pair{400, 400}, std::pair{800, 480}}) {
    const io::Image image = io::decode_raster(report::still_png(view, 0, wide, high), "preview");
    print::JobPreview preview{.width_px = image.width, .height_px = image.height, .rgb = {}};
    for (const float v : image.data)
      preview.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0f, 1.0f))));
    previews.push_back(std::move(preview));
  }
  return previews;
}

}  // namespace gonio::tools::dlp_slice
