// Built-in scenes (render/specimen.h).
//
// The knot is a tube of radius r around the torus knot (2, 3),
//   c(t) = ((R + a cos 3t) cos 2t, (R + a cos 3t) sin 2t, a sin 3t),   t in [0, 2 pi),
// with rings of a frame that is carried along without twist (double reflection: Wang et al. 2008, table 1) and turned
// evenly so that the last ring meets the first.
#include "render/specimen.h"

#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "camera/intrinsics.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/looking_at.h"
#include "render/specimen_board.h"
#include "render/specimen_camera.h"
#include "render/specimen_glass.h"
#include "render/specimen_goniometer.h"
#include "render/specimen_matrix.h"
#include "render/specimen_mirror_ball.h"

namespace gonio::render {
namespace {

constexpr double knot_radius_m = 0.04, knot_swing_m = 0.018, tube_radius_m = 0.011;
constexpr int knot_rings = 360, knot_sectors = 28;

Vec3 knot_point(double t) {
  const double reach = knot_radius_m + knot_swing_m * std::cos(3 * t);
  return {reach * std::cos(2 * t), reach * std::sin(2 * t), knot_swing_m * std::sin(3 * t)};
}
Vec3 knot_tangent(double t) {
  return normalized(knot_point(t + 1e-5) - knot_point(t - 1e-5));
}

// Carries `normal` from ring to ring by two reflections.
Vec3 carried(Vec3 normal, Vec3 from, Vec3 to, Vec3 tangent_from, Vec3 tangent_to) {
  const auto reflected = [](Vec3 v, Vec3 about) { return v - about * (2 * dot(about, v) / dot(about, about)); };
  const Vec3 step = to - from;
  return reflected(reflected(normal, step), tangent_to - reflected(tangent_from, step));
}

std::vector<Vec3> knot_normals() {
  std::vector<Vec3> normals = {Basis(knot_tangent(0)).t};
  const auto at = [](int ring) { return 2 * pi * ring / knot_rings; };
  for (int ring = 1; ring <= knot_rings; ++ring)
    normals.push_back(carried(normals.back(), knot_point(at(ring - 1)), knot_point(at(ring)),
                              knot_tangent(at(ring - 1)), knot_tangent(at(ring))));
  const double gap =
      std::atan2(dot(cross(normals.back(), normals.front()), knot_tangent(0)), dot(normals.back(), normals.front()));
  for (int ring = 0; ring < knot_rings; ++ring) {
    const double angle = gap * ring / knot_rings;
    Vec3& n = normals[static_cast<std::size_t>(ring)];
    n = n * std::cos(angle) + cross(knot_tangent(at(ring)), n) * std::sin(angle);
  }
  normals.pop_back();
  return normals;
}

io::TriangleMesh knot() {
  io::TriangleMesh mesh;
  const std::vector<Vec3> normals = knot_normals();
  for (int ring = 0; ring < knot_rings; ++ring) {
    const double t = 2 * pi * ring / knot_rings;
    const Vec3 n = normals[static_cast<std::size_t>(ring)], b = cross(knot_tangent(t), n);
    for (int sector = 0; sector < knot_sectors; ++sector) {
      const double angle = 2 * pi * sector / knot_sectors;
      const Vec3 out = n * std::cos(angle) + b * std::sin(angle);
      mesh.positions_m.push_back(knot_point(t) + out * tube_radius_m);
      mesh.normals.push_back(out);
    }
  }
  const auto vertex = [](int ring, int sector) {
    return static_cast<std::uint32_t>(ring % knot_rings * knot_sectors + sector % knot_sectors);
  };
  for (int ring = 0; ring < knot_rings; ++ring)
    for (int sector = 0; sector < knot_sectors; ++sector) {
      const std::uint32_t a = vertex(ring, sector), b = vertex(ring + 1, sector), c = vertex(ring + 1, sector + 1),
                          d = vertex(ring, sector + 1);
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

manifest::Parameter free_albedo(std::vector<double> rgb) {
  manifest::Parameter albedo(std::move(rgb));
  albedo.free = true;
  albedo.min = 0;
  albedo.max = 1;
  return albedo;
}

void add_surface(manifest::Document& document, const std::string& id, std::vector<double> rgb) {
  document.surfaces[id].parameters["albedo"] = free_albedo(std::move(rgb));
}

void add_object(manifest::Document& document, const std::string& id, const std::string& mesh,
                const std::string& surface, Vec3 translation_m) {
  manifest::Object object{.id = id, .mesh = mesh, .surface = surface, .world_from_object = {}};
  object.world_from_object.emplace().translation_m = translation_m;
  document.objects.push_back(object);
}

void add_table(manifest::Document& document) {
  document.meshes["table"].plane_size_m = {1.2, 1.2};
  add_surface(document, "table", {0.55, 0.52, 0.48});
  add_object(document, "table", "table", "table", {});
}

void add_lamps(manifest::Document& document) {
  const std::vector<std::vector<double>> positions_m = {{0.24, -0.22, 0.40}, {-0.27, -0.18, 0.38}, {0.04, 0.06, 0.52}};
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    manifest::Parameter intensity(std::vector<double>{1, 1, 1});
    intensity.free = true;
    intensity.min = 0;
    intensity.share = "intensity";
    manifest::Light& lamp = document.lights["lamp-" + std::to_string(i)];
    lamp.parameters = {{"position_m", positions_m[i]}, {"watt_per_sr", intensity}};
  }
}

void add_images(manifest::Document& document) {
  camera::enter_pinhole(document, "camera", 160, 160, 420);
  const std::vector<Vec3> positions_m = {{0, -0.44, 0.26}, {0.32, -0.28, 0.24}, {-0.30, -0.26, 0.34}};
  for (std::size_t i = 0; i < positions_m.size(); ++i)
    for (const auto& [lamp, unused] : document.lights)
      add_view(document, {.id = "view-" + std::to_string(i) + "-" + lamp,
                          .world_from_camera = {looking_at(positions_m[i], {0, 0, 0.03}), {}},
                          .light = {lamp}});
}

void add_spheres(manifest::Document& document, const std::filesystem::path&) {
  document.meshes["large"].sphere_radius_m = 0.04;
  document.meshes["small"].sphere_radius_m = 0.025;
  add_surface(document, "clay", {0.62, 0.36, 0.24});
  add_object(document, "large", "large", "clay", {-0.03, 0.01, 0.04});
  add_object(document, "small", "small", "clay", {0.04, -0.02, 0.025});
}

void add_knot(manifest::Document& document, const std::filesystem::path& out) {
  make_folder(out);
  io::write_ply(out / "knot.ply", knot());
  document.meshes["knot"].file = manifest::add_file(document, out / "knot.ply", "knot");
  add_surface(document, "knot", {0.62, 0.36, 0.24});
  // Its lowest point rests on the table.
  add_object(document, "knot", "knot", "knot", {0, 0, knot_swing_m + tube_radius_m});
}

}  // namespace

const std::vector<Specimen>& specimens() {
  static const std::vector<Specimen> all = {
      {"knot", "a trefoil knot of a round tube on a table; writes knot.ply"},
      {"spheres", "two spheres on a table"},
      {"glass",
       "a glass bowl on a cloth under a sky; writes bowl.ply, cloth.exr "
       "and sky.exr"},
      {"board", "a calibration board from twelve sides; writes board.png"},
      {"goniometer",
       "a flat sample and a white tile under three lamps on an arc, from 21 "
       "sides"},
      {"arc", "the same in steps of 7.5 degrees, 2783 images"},
      {"matrix",
       "a plate of micro-ridges, a data matrix, before and after a turn by a "
       "quarter, ten images; writes plate.ply"},
      {"mirror-ball", "a chromium ball under a sky, from three sides; writes sky.exr"}};
  return all;
}

manifest::Document specimen(const std::string& name, const std::filesystem::path& out) {
  if (name == "board") return board_specimen(out);
  if (name == "glass") return glass_specimen(out);
  if (name == "goniometer") return goniometer_specimen({.step_rad = pi / 8});
  if (name == "arc") return goniometer_specimen({});
  if (name == "matrix") return matrix_specimen(out);
  if (name == "mirror-ball") return mirror_ball_specimen(out);
  manifest::Document document;
  if (name == "knot")
    add_knot(document, out);
  else if (name == "spheres")
    add_spheres(document, out);
  else
    throw Error(Exit::usage, "--specimen", "there is no specimen \"" + name + "\"",
                "choose knot, spheres, glass, board, goniometer, arc, matrix or mirror-ball");
  add_table(document);
  add_lamps(document);
  add_images(document);
  return document;
}

}  // namespace gonio::render
