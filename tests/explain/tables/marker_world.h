// Two pieces, "1" on the table with an estimated pose and "2" above it with a known one, whose markers cameras on a
// ring see. Small, and without errors of cameras and tomograph: tests/sealed/markers_world.cpp has those, and glass.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {

struct Pieces {
  std::array<bool, 2> estimated{true, false};
  double glue_m = 0, scale = 0, noise_px = 0.1;
  std::array<Vec3, 2> moved_m{};
  Vec3 nudged_m{};  // piece 2, in images of the second sitting
  bool balls = false;
  bool glass = false;  // a plate before all markers of piece 2, flat on the world's x
  std::string parameters{};
};

inline std::vector<std::array<Vec3, 2>> marker_places(bool balls, std::uint64_t seed) {  // with their normals
  Random random(seed, 11);
  std::vector<std::array<Vec3, 2>> places;
  for (int i = 0; i < 8; ++i) {
    Vec3 n = normalized(Vec3{random.normal(), random.normal(), 0.3 + std::abs(random.normal())});
    Vec3 x = n * 0.05;
    if (!balls && i % 2 == 0) x = Vec3{0.03, 0.01, 0.02} + cross(n, {0, 0, 1}) * 0.06;
    places.push_back({x, n});
  }
  return places;
}

inline World marker_world(std::uint64_t seed, const Pieces& p = {}) {
  World w;
  w.columns = {{"image", ""},  {"piece", ""},        {"marker", ""},      {"x_m", "m"}, {"y_m", "m"},
               {"z_m", "m"},   {"nx", "1"},          {"ny", "1"},         {"nz", "1"},  {"u_px", "px"},
               {"v_px", "px"}, {"u_sigma_px", "px"}, {"v_sigma_px", "px"}};
  if (p.glass)
    for (const char* name : {"glass_path_m", "glass_behind_m"}) w.columns.emplace_back(name, "m");
  if (p.glass)
    for (const char* name : {"glass_in_x", "glass_in_y", "glass_in_z", "glass_out_x", "glass_out_y", "glass_out_z"})
      w.columns.emplace_back(name, "1");
  w.rest = R"("model": "markers", "observed": ["u_px", "v_px"], "sigma": ["u_sigma_px", "v_sigma_px"])" +
           (p.parameters.empty() ? "" : ", \"parameters\": {" + p.parameters + "}");
  w.sections = R"("cameras": {"c": {"model": "pinhole", "width_px": 2000, "height_px": 2000, "fx_px": 3000,
    "fy_px": 3000, "cx_px": 1000, "cy_px": 1000}}, "meshes": {"m": {"sphere": {"radius_m": 0.05}}},
    "surfaces": {"s": {"model": "diffuse", "albedo": 0.5}}, "objects": [)";
  const std::array<Vec3, 2> stands{Vec3{0, 0, 0.05}, Vec3{0.01, 0.02, 0.15}};
  for (std::size_t k = 0; k < 2; ++k)
    w.sections +=
        std::string(k == 0 ? "" : ", ") + R"({"id": ")" + std::to_string(k + 1) +
        R"(", "mesh": "m", "surface": "s", "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [)" +
        shortest_text(stands[k].x) + "," + shortest_text(stands[k].y) + "," + shortest_text(stands[k].z) + "]" +
        (p.estimated[k] ? R"(, "sigma": {"rotation_rad": [1e-3], "translation_m": [1e-4]})" : "") + "}}";
  w.sections += R"(], "images": [)";
  const auto places = marker_places(p.balls, seed);
  Random random(seed, 12);
  for (int view = 0; view < 8; ++view) {
    const double azimuth = 0.8 * view, z = view % 2 == 0 ? 0.5 : 0.9;
    const Vec3 eye{0.7 * std::cos(azimuth), 0.7 * std::sin(azimuth), z};
    const Vec3 forward = normalized(Vec3{0, 0, 0.1} - eye), right = normalized(cross(forward, {0, 0, 1}));
    const Vec3 down = cross(forward, right);
    w.sections += std::string(view == 0 ? "" : ", ") + R"({"id": ")" + std::to_string(view + 1) +
                  R"(", "camera": "c", "group": ")" + (view % 4 < 2 ? "first" : "second") +
                  R"(", "world_from_camera": {"matrix": [)";
    for (int row = 0; row < 3; ++row)
      w.sections += "[" + shortest_text(right[row]) + "," + shortest_text(down[row]) + "," +
                    shortest_text(forward[row]) + "," + shortest_text(eye[row]) + "],";
    w.sections += "[0,0,0,1]]}}";
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t m = 0; m < places.size(); ++m) {
        const auto [x, n] = places[m];
        Vec3 at = x / (1 + p.scale) + n * p.glue_m + stands[k] + p.moved_m[k];
        if (k == 1 && view % 4 >= 2) at += p.nudged_m;
        const Vec3 seen = at - eye;
        const double depth = dot(seen, forward);
        w.rows.push_back({view + 1.0, k + 1.0, 1.0 + m + 100.0 * k, x.x, x.y, x.z, n.x, n.y, n.z,
                          1000 + 3000 * dot(seen, right) / depth + p.noise_px * random.normal(),
                          1000 + 3000 * dot(seen, down) / depth + p.noise_px * random.normal(), p.noise_px,
                          p.noise_px});
        if (!p.glass) continue;
        const double side = eye.x > 0 ? 1 : -1, lean = std::abs(normalized(seen).x);
        const bool before = k == 1 && lean > 0.2;
        for (const double v : {before ? 4e-3 / lean : 0.0, 0.1, side, 0.0, 0.0, -side, 0.0, 0.0})
          w.rows.back().push_back(v);
      }
  }
  w.sections += "],";
  return w;
}

}  // namespace gonio::explain::tables::tests
