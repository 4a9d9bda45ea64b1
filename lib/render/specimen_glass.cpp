// The bowl's profile in the half plane (r, z), anticlockwise seen with r to the right and z up, so that the surface of
// revolution looks outwards: the foot's disc, the outer quarter circle up to the rim, a half circle of the wall's
// thickness over the rim, the inner quarter circle down to the axis.
#include "render/specimen_glass.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "camera/intrinsics.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "mesh/revolve.h"
#include "render/looking_at.h"
#include "render/specimen_camera.h"

namespace gonio::render {
namespace {

constexpr double bowl_radius_m = 0.06, bowl_wall_m = 0.005, cloth_m = 0.5;

using mesh::ProfilePoint;

std::vector<ProfilePoint> profile(double radius_m, double wall_m) {
  constexpr int arc = 48, rim = 16;
  const double foot = std::asin(0.45);  // polar angle, from -z, up to which the outer sphere is cut flat
  const double lift = radius_m * std::cos(foot), inner = radius_m - wall_m;
  std::vector<ProfilePoint> points;
  for (int i = 1; i <= 8; ++i) points.push_back({radius_m * std::sin(foot) * i / 8, 0, {0, -1}});
  for (int i = 1; i <= arc; ++i) {
    const double a = foot + (pi / 2 - foot) * i / arc;
    points.push_back({radius_m * std::sin(a), lift - radius_m * std::cos(a), {std::sin(a), -std::cos(a)}});
  }
  for (int i = 1; i < rim; ++i) {
    const double a = pi * i / rim, middle = radius_m - wall_m / 2;
    points.push_back({middle + wall_m / 2 * std::cos(a), lift + wall_m / 2 * std::sin(a), {std::cos(a), std::sin(a)}});
  }
  // The inside is a little shallower than a hemisphere, so that the bottom is thicker than the foot is deep.
  const double depth = std::min(inner, lift - wall_m);
  for (int i = arc; i >= 1; --i) {
    const double a = pi / 2 * i / arc, r = inner * std::sin(a), down = depth * std::cos(a);
    const Vec2 normal{-std::sin(a) * depth, std::cos(a) * inner};  // of the ellipse, towards the axis and up
    points.push_back({r, lift - down, normal * (1 / norm(normal))});
  }
  return points;
}

io::Image cloth() {
  constexpr int size = 256, threads = 32;
  io::Image picture(size, size, {"R", "G", "B"});
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double u = x * threads / static_cast<double>(size), v = y * threads / static_cast<double>(size);
      const bool warp = (static_cast<int>(u) + static_cast<int>(v)) % 2 == 0;  // plain weave
      const double across = warp ? u - std::floor(u) : v - std::floor(v);
      const double thread = 0.75 + 0.25 * std::sin(pi * across);
      const bool blue = (warp ? static_cast<int>(u) : static_cast<int>(v)) % 8 < 2;
      const Rgb colour = (blue ? Rgb{0.12, 0.20, 0.42} : Rgb{0.72, 0.68, 0.60}) * thread;
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(colour[c]);
    }
  return picture;
}

}  // namespace

io::Image sky_with_windows() {
  constexpr int width = 256, height = 128;
  io::Image picture(width, height, {"R", "G", "B"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double elevation = 90 - 180 * (y + 0.5) / height, azimuth = 360 * (x + 0.5) / width;
      Rgb radiance = elevation > 0 ? Rgb{0.25, 0.28, 0.32} * (0.5 + elevation / 90) : Rgb{0.08, 0.07, 0.06};
      const bool tall = azimuth > 40 && azimuth < 75 && elevation > 15 && elevation < 60;
      const bool wide = azimuth > 200 && azimuth < 260 && elevation > 25 && elevation < 45;
      const bool bar = std::fmod(azimuth, 12) < 1.5;
      if (tall && !bar) radiance = {9, 8.4, 7.5};
      if (wide && !bar) radiance = {4, 4.6, 5.6};
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(radiance[c]);
    }
  return picture;
}

io::TriangleMesh bowl(double radius_m, double thickness_m, int sectors) {
  return mesh::revolved(profile(radius_m, thickness_m), sectors);
}

manifest::Document glass_specimen(const std::filesystem::path& out) {
  make_folder(out);
  io::write_ply(out / "bowl.ply", bowl(bowl_radius_m, bowl_wall_m, 192));
  io::write_picture(out / "cloth.exr", cloth());
  io::write_picture(out / "sky.exr", sky_with_windows());
  manifest::Document document;
  document.meshes["bowl"].file = manifest::add_file(document, out / "bowl.ply", "bowl");
  document.meshes["cloth"].plane_size_m = {cloth_m, cloth_m};
  manifest::Surface& glass = document.surfaces["glass"];
  glass.model = "dielectric";
  glass.parameters = {{"eta", 1.52}, {"sigma_a_per_m", std::vector<double>{12, 3, 9}}};  // a green bottle's
  document.surfaces["cloth"].textures["albedo"] = manifest::add_file(document, out / "cloth.exr", "cloth");
  manifest::Light& sky_light = document.lights["sky"];
  sky_light.model = "lat-long";
  sky_light.file = manifest::add_file(document, out / "sky.exr", "sky");
  const auto add = [&](const char* id, const char* surface, double z_m) {
    manifest::Object object{.id = id, .mesh = id, .surface = surface, .world_from_object = {}};
    object.world_from_object.emplace().translation_m = {0, 0, z_m};
    document.objects.push_back(object);
  };
  add("cloth", "cloth", 0);
  add("bowl", "glass", 0.0005);  // on the cloth's threads, not in them
  camera::enter_pinhole(document, "camera", 320, 240, 560);
  const Vec3 bowl_m{0, 0, 0.022};
  add_view(document, {.id = "front", .world_from_camera = {looking_at({0.02, -0.30, 0.16}, bowl_m), {}}});
  add_view(document, {.id = "side", .world_from_camera = {looking_at({0.26, -0.12, 0.22}, bowl_m), {}}});
  return document;
}

}  // namespace gonio::render
