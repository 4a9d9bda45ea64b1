// See specimen.h.
#include "reassembly/specimen.h"

#include <array>
#include <cmath>

#include "base/atomic_file.h"
#include "base/progress.h"
#include "base/random.h"
#include "camera/intrinsics.h"
#include "geom/angle.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/volume.h"
#include "render/entries.h"
#include "render/looking_at.h"
#include "render/session.h"
#include "render/specimen_glass.h"
#include "render/virtual_sensor.h"

namespace gonio::reassembly {
namespace {

using manifest::Document;
namespace fs = std::filesystem;

constexpr double bowl_m = 0.06, wall_m = 0.005, marker_m = 0.0025, glued = 0.9;  // of a radius: glue holds a cap
constexpr double tomograph_sigma_m = 8e-6;
const double bowl_middle_m = bowl_m * std::cos(std::asin(0.45));  // render/specimen_glass.cpp: where the rim is
const double rim_m = bowl_middle_m + wall_m / 2;

struct Part {
  std::string name;
  io::TriangleMesh mesh;
  std::vector<Vec3> markers_m;  // true centres, object frame
  Rigid<frame::World, frame::Object> world_from_object;
};

// A profile (r, z) from the axis round to the axis, anticlockwise, turned about z.
io::TriangleMesh turned(const std::vector<Vec2>& profile, std::uint32_t sectors) {
  io::TriangleMesh mesh;
  const auto rings = static_cast<std::uint32_t>(profile.size() - 2);
  mesh.positions_m.push_back({0, 0, profile.front().y});
  for (std::uint32_t k = 0; k < rings; ++k)
    for (std::uint32_t s = 0; s < sectors; ++s) {
      const double phi = 2 * pi * s / sectors;
      mesh.positions_m.push_back(
          {profile[k + 1].x * std::cos(phi), profile[k + 1].x * std::sin(phi), profile[k + 1].y});
    }
  mesh.positions_m.push_back({0, 0, profile.back().y});
  const std::uint32_t last = rings * sectors + 1;
  for (std::uint32_t s = 0; s < sectors; ++s) {
    const std::uint32_t t = (s + 1) % sectors;
    mesh.triangles.push_back({0, 1 + t, 1 + s});
    mesh.triangles.push_back({last, last - sectors + s, last - sectors + t});
    for (std::uint32_t k = 0; k + 1 < rings; ++k) {
      const std::uint32_t a = 1 + k * sectors + s, b = 1 + k * sectors + t, c = a + sectors, d = b + sectors;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

Part bowl_part() {
  Part part{.name = "bowl", .mesh = render::bowl(bowl_m, wall_m, 128), .markers_m = {}, .world_from_object = {}};
  constexpr std::array<std::array<double, 2>, 9> places{{{-4, -30},
                                                         {31, -12},
                                                         {68, -33},
                                                         {97, -8},
                                                         {141, -24},
                                                         {186, -13},
                                                         {222, -35},
                                                         {263, -19},
                                                         {318, -7}}};  // degrees
  for (const auto& [azimuth, elevation] : places) {
    const double a = azimuth * degree, e = elevation * degree, reach = bowl_m + glued * marker_m;
    part.markers_m.push_back(
        {reach * std::cos(e) * std::cos(a), reach * std::cos(e) * std::sin(a), bowl_middle_m + reach * std::sin(e)});
  }
  part.world_from_object = {quaternion_of_rotation_vector({0, 0, 0.35}), {0.02, -0.01, 0}};
  return part;
}

Part lid_part() {
  constexpr double thick = 0.004, knob = 0.009;
  const double over = bowl_m + 0.003;
  std::vector<Vec2> profile{{0, 0}, {over - 0.001, 0}};
  for (int k = 0; k <= 6; ++k) {  // a rounded edge
    const double a = pi * (k / 6.0 - 0.5);
    profile.push_back({over - thick / 2 + thick / 2 * std::cos(a), thick / 2 + thick / 2 * std::sin(a)});
  }
  for (int k = 0; k <= 16; ++k) {  // the knob: most of a ball on the plate
    const double a = -0.7 + (pi / 2 + 0.7) * k / 16;
    const double r = knob * std::cos(a);
    profile.push_back({k == 16 ? 0.0 : r, thick + knob * (std::sin(0.7) + std::sin(a))});
  }
  profile[1].x = profile[2].x;
  profile.erase(profile.begin() + 2);
  Part part{.name = "lid", .mesh = turned(profile, 128), .markers_m = {}, .world_from_object = {}};
  constexpr std::array<std::array<double, 2>, 7> places{
      {{12, 48}, {55, 26}, {103, 52}, {160, 38}, {205, 55}, {261, 30}, {312, 50}}};  // degrees, mm
  for (const auto& [azimuth, mm] : places)
    part.markers_m.push_back(
        {1e-3 * mm * std::cos(azimuth * degree), 1e-3 * mm * std::sin(azimuth * degree), thick + glued * marker_m});
  part.world_from_object = {quaternion_of_rotation_vector({0, 0, -0.8}), {0.02, -0.01, rim_m + 1e-6}};
  return part;
}

// The cloth before the bowl pressed it: soft hills a little higher than where the bowl's foot came to lie.
io::TriangleMesh cloth() {
  constexpr std::uint32_t cells = 100;
  constexpr double size_m = 0.5;
  io::TriangleMesh mesh;
  for (std::uint32_t j = 0; j <= cells; ++j)
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const double x = size_m * (i / double{cells} - 0.5), y = size_m * (j / double{cells} - 0.5);
      mesh.positions_m.push_back({x, y, 4e-4 * std::sin(60 * x + 1) * std::cos(47 * y) + 1e-4});
    }
  for (std::uint32_t j = 0; j < cells; ++j)
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

void add_surfaces(Document& document) {
  manifest::Surface porcelain, marker, table;
  porcelain.parameters["albedo"] = manifest::Parameter(std::vector<double>{0.55, 0.6, 0.66});
  marker.parameters["albedo"] = manifest::Parameter(std::vector<double>{0.06, 0.05, 0.05});
  table.parameters["albedo"] = manifest::Parameter(std::vector<double>{0.3, 0.24, 0.2});
  document.surfaces = {{"porcelain", porcelain}, {"marker", marker}, {"background", table}};
}

void add_lights(Document& document) {
  const auto lamp = [](std::vector<double> place, double watt_per_sr) {
    manifest::Light light;
    light.model = "point";
    light.parameters["position_m"] = manifest::Parameter(std::move(place));
    light.parameters["watt_per_sr"] = manifest::Parameter(std::vector<double>{watt_per_sr, watt_per_sr, watt_per_sr});
    return light;
  };
  document.lights = {{"key", lamp({0.5, -0.7, 1.1}, 2)}, {"fill", lamp({-0.9, 0.5, 0.8}, 0.9)}};
}

void add_camera_and_images(Document& document, const SpecimenWish& wish) {
  camera::Intrinsics lens;
  lens.fx_px = lens.fy_px = 2.1 * wish.width_px;
  lens.cx_px = 0.5 * (wish.width_px - 1), lens.cy_px = 0.5 * (wish.height_px - 1);
  for (const char* name : {"left", "right"}) {
    manifest::Camera camera;
    camera.width_px = wish.width_px, camera.height_px = wish.height_px;
    camera.fx_px = camera.fy_px = 2.1 * wish.width_px;
    camera.cx_px = lens.cx_px, camera.cy_px = lens.cy_px;
    document.cameras[name] = camera;
  }
  int number = 0;
  for (const double azimuth : {-60.0, 40.0, 150.0}) {
    const double a = azimuth * degree, e = 28 * degree;
    const Vec3 side{-std::sin(a), std::cos(a), 0};
    const Vec3 stand = 0.42 * Vec3{std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
    ++number;
    for (const double half : {-0.04, 0.04}) {
      manifest::PlannedImage image;
      image.camera = half < 0 ? "left" : "right";
      image.id = image.camera + std::to_string(number);
      static_cast<Rigid<frame::World, frame::Camera>&>(image.world_from_camera) =
          render::looking_at(stand + half * side + Vec3{0, 0, 0.03}, {0.02, -0.01, 0.03});
      image.world_from_camera.sigma = manifest::PoseSigma{{2e-5}, {2e-5}};
      image.noise = manifest::Noise{.gain = 20000, .read = 0.0005};
      manifest::enter_image(document, image);
    }
  }
}

void add_object(Document& document, const fs::path& file, const std::string& name, const io::TriangleMesh& mesh,
                const std::string& surface, std::optional<Rigid<frame::World, frame::Object>> place) {
  io::write_ply(file, mesh);
  document.meshes[name].file = manifest::add_file(document, file, name);
  manifest::Object object{.id = name, .mesh = name, .surface = surface, .world_from_object = {}};
  if (place) {
    object.world_from_object.emplace();
    static_cast<Rigid<frame::World, frame::Object>&>(*object.world_from_object) = *place;
  }
  document.objects.push_back(std::move(object));
}

void write_piece(const Part& part, const fs::path& out, std::uint64_t seed) {
  Document piece;
  piece.folder = out;
  add_surfaces(piece);
  std::erase_if(piece.surfaces, [](const auto& s) { return s.first != "porcelain"; });
  add_object(piece, out / (part.name + ".ply"), part.name, part.mesh, "porcelain", {});
  Random random(seed);
  for (std::size_t m = 0; m < part.markers_m.size(); ++m) {
    const Vec3 c = part.markers_m[m];
    const double v = tomograph_sigma_m * tomograph_sigma_m;
    piece.markers.push_back(
        {.id = part.name + "-" + std::to_string(m + 1),
         .object = part.name,
         .centre_m = {c.x + tomograph_sigma_m * random.normal(), c.y + tomograph_sigma_m * random.normal(),
                      c.z + tomograph_sigma_m * random.normal()},
         .radius_m = marker_m,
         .covariance_m2 = {v, 0, 0, 0, v, 0, 0, 0, v}});
  }
  write_file(out / (part.name + ".json"), manifest::print_document(piece, out));
}

void photograph(Document& truth, Document& rig, const fs::path& out, const SpecimenWish& wish) {
  render::SessionOptions options;
  options.seed = wish.seed;
  options.geometry = false;
  options.spp = wish.spp;
  options.force = true;
  const render::Session session(truth, options, [](const fs::path&) {});
  Progress progress("photographs", truth.images.size());
  for (std::size_t i = 0; i < truth.images.size(); ++i) {
    const fs::path file = out / (truth.images[i].id + ".exr");
    const render::Rendered rendered = session.render(i, file);
    io::write_picture(file, render::recorded(rendered.picture, *truth.images[i].noise, truth.images[i].id, wish.seed));
    render::Session::remove_checkpoint(file);
    render::enter_recording(truth, i, file);
    render::enter_recording(rig, i, file);
    progress.advance();
  }
}

}  // namespace

Document specimen(const fs::path& out, const SpecimenWish& wish) {
  Document rig;
  rig.folder = out;
  add_surfaces(rig);
  add_lights(rig);
  add_camera_and_images(rig, wish);
  Document truth = rig;
  const std::array<Part, 2> parts{bowl_part(), lid_part()};
  for (const Part& part : parts) {
    write_piece(part, out, wish.seed + part.name.size());
    add_object(truth, out / (part.name + ".ply"), part.name, part.mesh, "porcelain", part.world_from_object);
    for (std::size_t m = 0; m < part.markers_m.size(); ++m) {
      const std::string name = part.name + "-" + std::to_string(m + 1);
      truth.meshes[name].sphere_radius_m = marker_m;
      manifest::Pose<frame::World, frame::Object> pose;
      pose.translation_m = part.world_from_object * part.markers_m[m];
      truth.objects.push_back(
          {.id = name, .mesh = name, .surface = "marker", .world_from_object = pose, .priority = 1});
    }
  }
  truth.meshes["table"].plane_size_m = std::vector<double>{0.5, 0.5};
  manifest::Pose<frame::World, frame::Object> below;
  below.translation_m = {0, 0, -1e-6};
  truth.objects.push_back({.id = "table", .mesh = "table", .surface = "background", .world_from_object = below});
  io::write_ply(out / "table.ply", cloth());
  photograph(truth, rig, out, wish);
  write_file(out / "truth.json", manifest::print_document(truth, out));
  return rig;
}

}  // namespace gonio::reassembly
