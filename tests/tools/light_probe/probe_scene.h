// Simulated probes: surroundings with lamps, mirror balls before cameras, rendered by the program `render`.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "geom/rigid.h"
#include "io/picture.h"
#include "probe/projection.h"
#include "probe/remap.h"
#include "process.h"

namespace gonio::tests {

inline constexpr double lamp_half_angle = 3 * pi / 180;

inline std::vector<Vec3> lamps() {
  return {normalized(Vec3{0.8, 0.5, 0.4}), normalized(Vec3{-0.6, 0.7, 0.3}), normalized(Vec3{-0.5, -0.8, 0.2}),
          normalized(Vec3{0.3, -0.4, 0.9}), normalized(Vec3{0.4, -0.7, -0.5})};
}
inline double angle_between(Vec3 a, Vec3 b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

// A sky with slow changes, a chequered floor, and five lamps with soft edges.
inline Rgb surroundings(Vec3 d) {
  const double tiles = std::sin(9 * std::atan2(d.y, d.x)) * std::sin(7 * d.z);
  Rgb value = Rgb{0.4, 0.5, 0.6} * (1 + 0.5 * d.z) + Rgb{0.1, 0.05, 0.02} * tiles;
  for (const Vec3& lamp : lamps()) {
    const double off = angle_between(d, lamp) / lamp_half_angle;
    value += Rgb{60, 50, 40} / (1 + std::pow(off, 12));
  }
  return value;
}
inline void write_surroundings(const std::filesystem::path& path, int columns) {
  const probe::SphereMap map = probe::sized(probe::Projection::lat_long, columns / 2);
  io::Image picture(map.width, map.height, {"R", "G", "B"});
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const Rgb v = surroundings(probe::direction_at(map, {x + 0.5, y + 0.5})->unit);
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(v[c]);
    }
  io::write_picture(path, picture);
}

// The camera at `eye`, which looks at `target`, z up: camera axes x right, y down, z forward.
inline std::string pose(Vec3 eye, Vec3 target) {
  const Vec3 forward = normalized(target - eye), right = normalized(cross(forward, {0, 0, 1})),
             down = cross(forward, right);
  const Quaternion q =
      quaternion_of(Mat3{{right.x, down.x, forward.x, right.y, down.y, forward.y, right.z, down.z, forward.z}});
  return format(R"({"rotation": [%.17g, %.17g, %.17g, %.17g], "translation_m": [%.17g, %.17g, %.17g]})", q.w, q.x, q.y,
                q.z, eye.x, eye.y, eye.z);
}

// An index that does not depend on the wavelength, for the ball and for light-probe --metal.
inline constexpr double metal_n = 3.1, metal_k = 3.3;
inline void write_metal(const std::filesystem::path& path) {
  write_file(path, format("DATA:\n  - type: tabulated nk\n    data: |\n        0.3 %g %g\n        0.9 %g %g\n", metal_n,
                          metal_k, metal_n, metal_k));
}

struct ProbeWorld {
  std::vector<Vec3> eyes, balls;
  double radius_m = 0.03;
  int pixels = 400, rows = 0;  // rows: 0, as many as columns
  double focal_px = 1100;
  std::string lights = R"({"sky": {"model": "lat-long", "file": "sky"}})";
};
inline std::string scene_text(const ProbeWorld& w) {
  const int rows = w.rows > 0 ? w.rows : w.pixels;
  std::string text = format(
      R"({"gonio": 1, "files": {"sky": {"path": "sky.exr"}}, "cameras": {"c": {"model": "radial-tangential",
  "width_px": %d, "height_px": %d, "fx_px": %g, "fy_px": %g, "cx_px": %g, "cy_px": %g,
  "distortion": {"k1": -0.2, "k2": 0.05, "p1": 0.001, "p2": -0.0005, "k3": 0}}},
  "meshes": {"ball": {"sphere": {"radius_m": %g}}},
  "surfaces": {"metal": {"model": "conductor", "eta": %g, "k": %g, "alpha": 0}}, "lights": )",
      w.pixels, rows, w.focal_px, w.focal_px, (w.pixels - 1) / 2.0, (rows - 1) / 2.0, w.radius_m, metal_n, metal_k);
  text += w.lights + R"(, "objects": [)";
  Vec3 middle{};
  for (std::size_t b = 0; b < w.balls.size(); ++b) {
    const Vec3 c = w.balls[b];
    middle += c / static_cast<double>(w.balls.size());
    text += format(R"(%s{"id": "ball%zu", "mesh": "ball", "surface": "metal", "world_from_object": )",
                   b == 0 ? "" : ", ", b);
    text += format(R"({"rotation": [1, 0, 0, 0], "translation_m": [%.17g, %.17g, %.17g]}})", c.x, c.y, c.z);
  }
  text += R"(], "images": [)";
  for (std::size_t v = 0; v < w.eyes.size(); ++v)
    text += (v == 0 ? "" : ", ") + format(R"({"id": "v%zu", "camera": "c", "world_from_camera": )", v) +
            pose(w.eyes[v], middle) + "}";
  return text + "]}";
}

// The manifest that render wrote, its pictures made those of the images.
inline std::string recorded(std::string manifest, std::size_t views) {
  for (std::size_t v = 0; v < views; ++v) {
    const std::string id = format("\"id\": \"v%zu\"", v);
    const auto at = manifest.find(id);
    if (at != std::string::npos) manifest.insert(at + id.size(), format(", \"file\": \"photo%zu\"", v));
  }
  const auto files = manifest.find("\"sky\": {");
  std::string entries;
  for (std::size_t v = 0; v < views; ++v) entries += format("\"photo%zu\": {\"path\": \"r/v%zu.exr\"}, ", v, v);
  if (files != std::string::npos) manifest.insert(files, entries);
  return manifest;
}

// Middle of the lamp in a latitude-longitude picture: by what is above a level of 5, within three of its radii.
inline Vec3 middle_of_lamp(const io::Image& map, Vec3 lamp) {
  const probe::SphereMap sphere{probe::Projection::lat_long, map.width, map.height};
  const std::vector<double> sr = probe::solid_angles(sphere);
  Vec3 sum{};
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const Vec3 d = probe::direction_at(sphere, {x + 0.5, y + 0.5})->unit;
      if (angle_between(d, lamp) > 3 * lamp_half_angle) continue;
      const double light = map.at(x, y, map.channel("G")) - 0.6;
      sum += d * (light * sr[static_cast<std::size_t>(y * map.width + x)]);
    }
  return normalized(sum);
}
inline Rgb integral(const io::Image& map) {
  const std::vector<double> sr = probe::solid_angles({probe::Projection::lat_long, map.width, map.height});
  Rgb sum{};
  for (std::size_t i = 0; i < sr.size(); ++i)
    sum += Rgb{map.data[3 * i], map.data[3 * i + 1], map.data[3 * i + 2]} * sr[i];
  return sum;
}

}  // namespace gonio::tests
