#include "render/specimen_goniometer.h"

#include <cmath>
#include <cstdio>

#include "camera/intrinsics.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/flat_patch.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/looking_at.h"
#include "render/specimen_camera.h"

namespace gonio::render {
namespace {

constexpr double patch_radius_m = 0.003, plate_m = 0.0075, tile_beside_m = 0.0085, tile_reflectance = 0.98;

std::string text(const char* format, double angle_rad) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, format, angle_rad / degree);
  return buffer;
}

Vec3 direction(double inclination_rad, double azimuth_rad) {
  return {std::sin(inclination_rad) * std::cos(azimuth_rad), std::sin(inclination_rad) * std::sin(azimuth_rad),
          std::cos(inclination_rad)};
}

void add_plate(manifest::Document& document, const std::string& id, const std::string& surface, Vec3 at_m) {
  manifest::Object object{.id = id, .mesh = "plate", .surface = surface, .world_from_object = {}};
  object.world_from_object.emplace().translation_m = at_m;
  document.objects.push_back(object);
  manifest::FlatPatch& patch = document.goniometer[id];
  patch.world_from_sample = object.world_from_object;
  patch.radius_m = patch_radius_m;
}

void add_plates(manifest::Document& document) {
  document.meshes["plate"].plane_size_m = {plate_m, plate_m};
  manifest::Surface& varnished = document.surfaces["sample"];
  varnished.model = "coated-diffuse";
  varnished.parameters = {{"albedo", std::vector<double>{0.45, 0.16, 0.08}}, {"f0", 0.04}, {"alpha", 0.2}};
  document.surfaces["tile"].parameters["albedo"] = manifest::Parameter(tile_reflectance);
  add_plate(document, "sample", "sample", {});
  add_plate(document, "tile", "tile", {0, tile_beside_m, 0});
  document.goniometer["sample"].tile = "tile";
  document.goniometer["tile"].reflectance = {tile_reflectance};
  document.goniometer["tile"].relative_sigma = 0.005;
}

void add_camera(manifest::Document& document, const Arc& arc) {
  camera::enter_pinhole(document, "camera", 96, 96, 96 * arc.camera_distance_m / 0.023);
}

}  // namespace

std::vector<double> arc_inclinations_rad(const Arc& arc) {
  std::vector<double> result;
  for (int i = 1; i * arc.step_rad < pi / 2 - 1e-9; ++i) result.push_back(i * arc.step_rad);
  return result;
}

std::vector<double> arc_azimuths_rad(const Arc& arc) {
  std::vector<double> result;
  for (int i = 2; i * arc.step_rad < pi + 1e-9; ++i) result.push_back(i * arc.step_rad);
  return result;
}

manifest::Document goniometer_specimen(const Arc& arc) {
  manifest::Document document;
  add_plates(document);
  add_camera(document, arc);
  const Vec3 middle_m{0, tile_beside_m / 2, 0};
  for (const double light : arc_inclinations_rad(arc)) {
    const std::string lamp = "light-" + text("%04.1f", light);
    document.lights[lamp].parameters = {{"position_m", std::vector<double>{arc.light_distance_m * std::sin(light), 0,
                                                                           arc.light_distance_m * std::cos(light)}},
                                        {"watt_per_sr", std::vector<double>{1, 1, 1}}};
    for (const double inclination : arc_inclinations_rad(arc))
      for (const double azimuth : arc_azimuths_rad(arc)) {
        const Vec3 at_m = middle_m + direction(inclination, azimuth) * arc.camera_distance_m;
        add_view(document, {.id = lamp + "_theta-" + text("%04.1f", inclination) + "_phi-" + text("%05.1f", azimuth),
                            .world_from_camera = {looking_at(at_m, middle_m), {}},
                            .light = {lamp}});
      }
  }
  return document;
}

}  // namespace gonio::render
