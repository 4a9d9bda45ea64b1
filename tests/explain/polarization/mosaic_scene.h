// A metal ball and a ball of black glass before a polarized screen, photographed by a polarization camera as render and
// its sensor have it.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "data.h"
#include "io/exr.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "mechanism/mechanism.h"
#include "render/looking_at.h"
#include "render/path_tracer.h"
#include "render/sensor_chain.h"
#include "scene/scene.h"

namespace gonio::explain::tests {

inline constexpr int mosaic_px = 48, mosaic_views = 4;

// `further`: sections behind "images", as ", \"mechanisms\": {...}". Angles of the screen in radians.
inline std::string mosaic_scene(const std::string& further = "", double degree = 0.98, double angle = 0.6,
                                double alpha = 0) {
  std::string images;
  for (int k = 0; k < mosaic_views; ++k) {
    const double a = 0.9 + 1.3 * k;
    const Vec3 eye{0.42 * std::cos(a), 0.42 * std::sin(a), 0.12};
    const Mat3 r = matrix_of(render::looking_at(eye, {}).rotation);
    images += format(
        R"(%s{"id": "i%d", "file": "i%d", "camera": "c", "light": ["screen", "panel"], "noise": {"gain": 8000, "read": 3e-4},
 "world_from_camera": {"matrix": [[%.17g,%.17g,%.17g,%.17g],[%.17g,%.17g,%.17g,%.17g],[%.17g,%.17g,%.17g,%.17g],[0,0,0,1]]}})",
        k == 0 ? "" : ",", k, k, r.m[0], r.m[1], r.m[2], eye.x, r.m[3], r.m[4], r.m[5], eye.y, r.m[6], r.m[7], r.m[8],
        eye.z);
  }
  std::string files;
  for (int k = 0; k < mosaic_views; ++k) files += format(R"(, "i%d": {"path": "i%d.exr"})", k, k);
  return format(
             R"({"gonio": 1, "files": {"white": {"path": "white.exr"}%s},
 "cameras": {"c": {"model": "pinhole", "width_px": %d, "height_px": %d, "fx_px": 75, "fy_px": 75, "cx_px": %g, "cy_px": %g,
                   "mosaic": "polarizers"}},
 "meshes": {"a": {"sphere": {"radius_m": 0.06}}, "b": {"sphere": {"radius_m": 0.06}}},
 "surfaces": {"metal": {"model": "conductor", "eta": 1.4, "k": 5, "alpha": %.17g},
              "glass": {"model": "dielectric", "eta": 1.5, "sigma_a_per_m": 1e6}},
 "objects": [{"id": "a", "mesh": "a", "surface": "metal",
              "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0.05, 0.05, 0]}},
             {"id": "b", "mesh": "b", "surface": "glass",
              "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [-0.05, -0.05, 0]}}],
 "lights": {"screen": {"model": "screen", "file": "white", "position_m": [0.36, 0, 0.03], "direction": [-1, 0, 0],
                       "up": [0, 0, 1], "width_m": 0.4, "height_m": 0.4, "polarization_rad": %.17g,
                       "polarization_degree": %.17g},
            "panel": {"model": "screen", "file": "white", "position_m": [-0.3, 0.25, 0.15], "direction": [0.7, -0.6, -0.3],
                      "up": [0, 0, 1], "width_m": 0.4, "height_m": 0.4, "polarization_degree": 0}},
 "images": [)",
             files.c_str(), mosaic_px, mosaic_px, 0.5 * (mosaic_px - 1), 0.5 * (mosaic_px - 1), alpha, angle, degree) +
         images + "]" + further + "}";
}

// What the scene's pictures are before a sensor, by its text without mechanisms and the seed: rendered once in a
// process, for tests that differ in what the camera does to the same light.
inline const std::vector<io::Image>& light_of_mosaics(manifest::Document document, std::uint64_t seed) {
  for (const auto& [id, use] : document.mechanisms)
    if (!render::in_sensor_chain(*mechanism::find_mechanism(id)))
      throw std::logic_error(id + " acts before the sensor");
  document.mechanisms.clear();
  static std::map<std::pair<std::string, std::uint64_t>, std::vector<io::Image>> known;
  std::vector<io::Image>& seen = known[{manifest::print_document(document, document.folder), seed}];
  if (!seen.empty()) return seen;
  const scene::Scene scene = scene::build_scene(document);
  const render::RayCaster caster(scene.instances);
  for (std::size_t k = 0; k < static_cast<std::size_t>(mosaic_views); ++k)
    seen.push_back(render::render(
        scene, k, caster,
        {.spp = 256, .seed = seed, .geometry = false, .transport = {.stokes = true, .from_lights = false}}));
  return seen;
}

// Photographs of the scene `made`, whose mechanisms are the camera's, into the folder.
inline void photograph_mosaics(const std::string& made, const std::filesystem::path& folder, std::uint64_t seed) {
  io::Image white(2, 2, {"R", "G", "B"});
  std::fill(white.data.begin(), white.data.end(), 1.0f);
  io::write_picture(folder / "white.exr", white);
  const manifest::Document document = manifest::parse_document(made, "made.json", folder);
  const std::vector<io::Image>& light = light_of_mosaics(document, seed);
  for (std::size_t k = 0; k < light.size(); ++k) {
    const std::string id = format("i%zu", k);
    io::write_picture(folder / (id + ".exr"), render::recorded(light[k], render::sensor_of(document, k), id, seed));
  }
}

}  // namespace gonio::explain::tests
