// A metal ball and a ball of black glass before a polarized screen, photographed by a polarization camera as render and
// its sensor have it.
#pragma once
#include <cmath>
#include <string>

#include "base/text.h"
#include "data.h"
#include "io/exr.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
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

// Photographs of the scene `made`, into the folder.
inline void photograph_mosaics(const std::string& made, const std::filesystem::path& folder, std::uint64_t seed) {
  io::Image white(2, 2, {"R", "G", "B"});
  std::fill(white.data.begin(), white.data.end(), 1.0f);
  io::write_picture(folder / "white.exr", white);
  const manifest::Document document = manifest::parse_document(made, "made.json", folder);
  const scene::Scene scene = scene::build_scene(document);
  const render::RayCaster caster(scene.instances);
  for (std::size_t k = 0; k < document.images.size(); ++k) {
    const io::Image seen = render::render(
        scene, k, caster,
        {.spp = 256, .seed = seed, .geometry = false, .transport = {.stokes = true, .from_lights = false}});
    io::write_picture(folder / (document.images[k].id + ".exr"),
                      render::recorded(seen, render::sensor_of(document, k), document.images[k].id, seed));
  }
}

}  // namespace gonio::explain::tests
