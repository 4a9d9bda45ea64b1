// A manifest for tests of sessions: a ball, a bump and a table under two lamps and a faint sky; with glass, a caustic.
#pragma once
#include <string>

#include "manifest/document.h"
#include "render/session.h"

namespace gonio::tests {

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from)) text.replace(at, from.size(), to);
  return text;
}

// `ball`: a surface. `tint`: the table's albedo at red, green and blue.
inline manifest::Document small_scene(const std::string& ball = R"({"model": "diffuse", "albedo": [0.6, 0.6, 0.6]})",
                                      const std::string& tint = "[0.5, 0.5, 0.5]") {
  const std::string text = replaced(replaced(R"({
 "gonio": 1,
 "cameras": {"c": {"model": "pinhole", "width_px": 18, "height_px": 12, "fx_px": 22, "fy_px": 22, "cx_px": 8.5,
   "cy_px": 5.5, "mosaic": "polarizers"}},
 "images": [{"id": "one", "camera": "c", "world_from_camera": {"rotation": [0, 1, 0, 0], "translation_m": [0, 0, 1]}},
   {"id": "two", "camera": "c", "light": "small",
    "world_from_camera": {"rotation": [0, 1, 0, 0], "translation_m": [0, 0, 0.9]}}],
 "meshes": {"ball": {"sphere": {"radius_m": 0.1}}, "table": {"plane": {"size_m": [2, 2]}}},
 "surfaces": {"ball": BALL, "table": {"model": "diffuse", "albedo": TINT}},
 "lights": {"large": {"model": "sphere", "position_m": [-0.4, 0.1, 0.8], "watt_per_sr": [1, 1, 1], "radius_m": 0.1},
   "small": {"model": "point", "position_m": [0.3, -0.2, 0.7], "watt_per_sr": [1, 1, 1]}},
 "objects": [{"id": "ball", "mesh": "ball", "surface": "ball",
     "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, 0.15]}},
   {"id": "bump", "mesh": "ball", "surface": "table",
     "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0.25, 0.05, 0]}},
   {"id": "table", "mesh": "table", "surface": "table"}],
 "mechanisms": {"light.ambient": {"radiance_r": 0.2, "radiance_g": 0.2, "radiance_b": 0.2}}
})",
                                             "BALL", ball),
                                    "TINT", tint);
  return manifest::parse_document(text, "small", ".");
}

inline const char* glass() {
  return R"({"model": "dielectric", "eta": [1.5, 1.5, 1.5], "alpha": 0})";
}

// Without `path` there is no place for checkpoints, however long it takes.
inline render::Rendered rendered(const manifest::Document& document, render::SessionOptions options,
                                 std::size_t image = 0, const std::filesystem::path& path = {}) {
  if (path.empty()) options.checkpoint_s = 1e9;
  return render::Session(document, options, {}).render(image, path.empty() ? "nowhere/one.exr" : path);
}

}  // namespace gonio::tests
