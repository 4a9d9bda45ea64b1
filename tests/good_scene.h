// A scene with which nothing is wrong, for tests that then spoil it: its manifest, its mesh, and how to spoil it.
#pragma once
#include <gtest/gtest.h>

#include <string>

#include "io/ply.h"

namespace gonio::tests {

// A body of glass (mesh.ply, below), a ball of clay and a table under one lamp.
inline const std::string good_scene = R"({"gonio": 1, "files": {"f": {"path": "mesh.ply"}, "t": {"path": "none.exr"}},
 "cameras": {"c": {"model": "pinhole", "width_px": 8, "height_px": 6, "fx_px": 10, "fy_px": 10,
                   "cx_px": 3.5, "cy_px": 2.5}},
 "meshes": {"m": {"file": "f"}, "ball": {"sphere": {"radius_m": 0.05}}, "table": {"plane": {"size_m": [1.2, 1.0]}}},
 "surfaces": {"clay": {"model": "diffuse", "albedo": 0.5}, "glass": {"model": "dielectric", "eta": 1.5}},
 "lights": {"lamp": {"model": "sphere", "position_m": [0, 0, 0.6], "watt_per_sr": 1, "radius_m": 0.01}},
 "objects": [{"id": "thing", "mesh": "m", "surface": "glass"},
             {"id": "ball", "mesh": "ball", "surface": "clay",
              "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0.3, 0, 0.05]}},
             {"id": "table", "mesh": "table", "surface": "clay",
              "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, -0.2]}}],
 "images": [{"id": "i", "camera": "c",
             "world_from_camera": {"rotation": [0, 1, 0, 0], "translation_m": [0, 0, 1]}}]})";

// The body of glass, closed.
inline io::TriangleMesh tetrahedron() {
  io::TriangleMesh mesh;
  mesh.positions_m = {{0, 0, 0.2}, {0.1, 0, 0.01}, {-0.1, 0.1, 0.01}, {-0.1, -0.1, 0.01}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  return mesh;
}

// The good scene with its first `from` replaced.
inline std::string good_scene_with(const std::string& from, const std::string& to) {
  std::string text = good_scene;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

}  // namespace gonio::tests
