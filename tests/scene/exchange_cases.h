// A scene that no two conventions show alike: an "F" of plates on a table under several lights, seen by an oblique
// camera whose principal point lies far off the centre.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "data.h"
#include "io/picture.h"
#include "scene/exchange/exchange.h"

namespace gonio::scene {

inline std::string letter_scene(double fy_px = 62) {
  std::string plates;
  const auto plate = [&](double x, double y, double z) {
    plates += R"({"id": "f)" + std::to_string(plates.size()) + R"(", "mesh": "plate", "surface": "paint",
      "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [)" +
              std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(z) + "]}},";
  };
  for (int i = 0; i < 5; ++i) plate(-0.2, 0.1 * i - 0.2, 0.02);
  for (int i = 1; i < 4; ++i) plate(-0.2 + 0.1 * i, 0.2, 0.02);
  for (int i = 1; i < 3; ++i) plate(-0.2 + 0.1 * i, 0.0, 0.02);
  return R"({"gonio": 1, "files": {"sky": {"path": "sky.exr"}},
 "cameras": {"c": {"model": "pinhole", "width_px": 64, "height_px": 40, "fx_px": 62, "fy_px": )" +
         std::to_string(fy_px) + R"(, "cx_px": 43.25, "cy_px": 11.5},
             "o": {"model": "orthographic", "width_px": 64, "height_px": 40, "px_per_m": 70, "cx_px": 40, "cy_px": 12}},
 "meshes": {"plate": {"plane": {"size_m": [0.09, 0.08]}}, "table": {"plane": {"size_m": [1, 0.8]}},
            "ball": {"sphere": {"radius_m": 0.06}}},
 "surfaces": {"paint": {"model": "diffuse", "albedo": [0.8, 0.5, 0.2]}, "wood": {"model": "diffuse", "albedo": 0.3},
              "gold": {"model": "metal", "f0": [0.9, 0.7, 0.3], "alpha": 0.2},
              "glaze": {"model": "coated-diffuse", "albedo": [0.2, 0.3, 0.8], "f0": 0.04, "alpha": 0.1}},
 "lights": {"lamp": {"model": "point", "position_m": [0.4, -0.3, 0.9], "watt_per_sr": [1, 2, 3]},
            "ball": {"model": "sphere", "position_m": [0.4, -0.3, 0.9], "watt_per_sr": [1, 2, 3], "radius_m": 0.02},
            "sun": {"model": "directional", "towards": [0.3, 0.2, 1], "watt_per_m2": [3, 2, 1]},
            "grey": {"model": "uniform", "radiance": [0.1, 0.2, 0.3]},
            "sky": {"model": "lat-long", "file": "sky", "rotation_rad": 0.7, "scale": [1, 1, 2]}},
 "objects": [)" +
         plates + R"(
   {"id": "table", "mesh": "table", "surface": "wood"},
   {"id": "gold", "mesh": "ball", "surface": "gold",
    "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0.3, -0.2, 0.06]}},
   {"id": "cup", "mesh": "ball", "surface": "glaze",
    "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0.35, 0.25, 0.06]}}],
 "images": [
   {"id": "lamp", "camera": "c", "light": "lamp", "gain": [2, 1, 0.5], "world_from_camera":
     {"rotation": [0.1, 0.9, 0.3, 0.3], "translation_m": [-0.75, 0, 1]}},
   {"id": "sun", "camera": "o", "light": "sun", "world_from_camera":
     {"rotation": [0.1, 0.9, 0.3, 0.3], "translation_m": [-0.75, 0, 1]}},
   {"id": "sky", "camera": "c", "light": "sky", "world_from_camera":
     {"rotation": [0.8, 0.4, 0.2, 0.4], "translation_m": [0, 0, 5]}}]})";
}

// The "sky": a step in every direction, so that turns and flips show.
inline void write_sky(const std::filesystem::path& path) {
  io::Image sky(32, 16, {"R", "G", "B"});
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x)
      for (int c = 0; c < 3; ++c)
        sky.at(x, y, c) = 0.2f + 0.03f * static_cast<float>(x) + (y < 5 ? 1.0f : 0.0f) +
                          (c == 0 && x < 8 ? 2.0f : 0.0f) + (c == 1 && y > 12 ? 1.5f : 0.0f);
  io::write_picture(path, sky);
}

class Letter {
 public:
  explicit Letter(double fy_px = 62) {
    write_sky(folder_ / "sky.exr");
    document = manifest::parse_document(letter_scene(fy_px), "s.json", folder_.path());
    scene = build_scene(document);
  }
  // Three times the pixels, and nothing that throws light onto the plates.
  void enlarge_without_balls();
  Exported exported(std::string_view format) const { return export_scene(scene, *find_exchange(format)); }
  const tests::ScratchFolder& folder() const { return folder_; }
  manifest::Document document;
  Scene scene;

 private:
  tests::ScratchFolder folder_;
};

inline const std::string& content_of(const Exported& exported, const std::string& name) {
  for (const ExchangedFile& file : exported.files)
    if (file.name == name) return file.content;
  throw std::runtime_error("no file " + name);
}

// Points in front of the letter scene's camera c, a letter again.
inline std::vector<Vec3> letter_points() {
  std::vector<Vec3> points;
  for (int i = 0; i < 5; ++i) points.push_back({-0.2, 0.1 * i - 0.2, 0.02});
  for (int i = 1; i < 4; ++i) points.push_back({-0.2 + 0.1 * i, 0.2, 0.05});
  for (int i = 1; i < 3; ++i) points.push_back({-0.2 + 0.1 * i, 0.0, 0.05});
  return points;
}

// The pixel of every point by `project` is the camera's own, to 0.05 px, for the view of `image`.
template <class Project>
void expect_same_pixels(const Scene& scene, std::size_t image, const Project& project) {
  const View& view = scene.views[image];
  for (const Vec3 p : letter_points()) {
    const auto here = view.camera.project(inverse(view.world_from_camera) * p);
    ASSERT_TRUE(here.has_value());
    const Vec2 there = project(p);
    EXPECT_NEAR(there.x, here->x, 0.05);
    EXPECT_NEAR(there.y, here->y, 0.05);
  }
}

// Lights the image of this id by these lamps alone; a camera that takes light as it comes.
void light_image(manifest::Document& document, const std::string& id, const std::vector<std::string>& lamps);

// Gives the camera c a lens that other programs do not have.
void bend_lens(manifest::Document& document);

// A scene with one surface of every kind, on balls.
manifest::Document every_look(const Letter& letter);

inline Exported every_look_in(const char* format) {
  const Letter letter;
  return export_scene(build_scene(every_look(letter)), *find_exchange(format));
}

}  // namespace gonio::scene
