// Cameras that no two conventions project alike, and points that no flip leaves in place, for the tests of exports.
#pragma once
#include <gmock/gmock.h>

#include <array>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.h"
#include "camera/camera_model.h"
#include "camera/export/formats.h"
#include "manifest/document.h"
#include "manifest/image_list.h"

namespace gonio::camera {

// An "F" with depth: neither mirrored nor turned does it look the same. In front of the cameras below.
inline std::vector<Vec3> letter_f() {
  std::vector<Vec3> points;
  for (int i = 0; i <= 8; ++i) points.push_back({-0.25, -0.4 + 0.1 * i, 2.0 + 0.03 * i});
  for (int i = 1; i <= 5; ++i) points.push_back({-0.25 + 0.1 * i, -0.4, 2.0 - 0.05 * i});
  for (int i = 1; i <= 3; ++i) points.push_back({-0.25 + 0.1 * i, -0.05, 2.2});
  return points;
}

inline manifest::Camera far_off_centre(bool square) {
  manifest::Camera c;
  c.model = "pinhole";
  c.width_px = 640;
  c.height_px = 400;
  c.fx_px = 512.25;
  c.fy_px = square ? 512.25 : 541.5;
  c.cx_px = 430.75;
  c.cy_px = 95.5;
  return c;
}

inline Rigid<frame::World, frame::Camera> exported_pose(std::size_t image) {
  const std::array turns{Vec3{0.3, -0.2, 0.5}, Vec3{-2.1, 0.7, 1.2}, Vec3{0.1, 2.6, -0.4}};
  const std::array places{Vec3{0.1, -0.3, 0.2}, Vec3{3.5, 2, -1}, Vec3{-0.6, 0.4, 5}};
  return {quaternion_of_rotation_vector(turns.at(image)), places.at(image)};
}

// One camera, two poses that are turned about all axes; a portrait format as the second camera.
inline manifest::Document exported_document(bool square) {
  manifest::Document document;
  document.name = "t";
  document.cameras["wide"] = far_off_centre(square);
  manifest::Camera tall = far_off_centre(square);
  tall.width_px = 300;
  tall.height_px = 700;
  tall.cx_px = 61.5;
  tall.cy_px = 512.25;
  document.cameras["tall"] = tall;
  for (std::size_t i = 0; i < 3; ++i)
    manifest::enter_image(document, {.id = std::string("v") + std::to_string(i),
                                     .camera = i == 1 ? "tall" : "wide",
                                     .world_from_camera = {exported_pose(i)}});
  return document;
}

inline std::string content_of(const std::vector<ExportedFile>& files, const std::string& name) {
  for (const ExportedFile& file : files)
    if (file.name == name) return file.content;
  throw std::runtime_error("no file " + name);
}

// For a document of exported_document(): `project` takes world coordinates to pixels, with pixel centres at integers,
// as the written file says.
template <class Project>
void expect_same_pixels(const manifest::Document& document, const std::string& image, const Project& project,
                        double limit_px = 0.05) {
  const std::size_t index = manifest::index_of_image(document, image).value();
  const CameraModel model(document.cameras.at(manifest::camera_of_image(document, index)), "t");
  for (const Vec3& in_camera : letter_f()) {
    const auto expected = model.project(in_camera);
    ASSERT_TRUE(expected);
    const Vec2 found = project(exported_pose(index) * in_camera);
    EXPECT_NEAR(found.x, expected->x, limit_px) << image;
    EXPECT_NEAR(found.y, expected->y, limit_px) << image;
  }
}

// The numbers that follow `key` in `text`, up to the first character that belongs to no list of numbers.
inline std::vector<double> numbers_after(const std::string& text, const std::string& key, std::size_t from = 0) {
  const std::size_t at = text.find(key, from);
  if (at == std::string::npos) throw std::runtime_error("no " + key);
  std::vector<double> numbers;
  const char* p = text.c_str() + at + key.size();
  while (*p == ' ' || *p == ',' || *p == '[' || *p == '=' || *p == '"' || *p == ':' || *p == '\n') ++p;
  while (true) {
    char* end = nullptr;
    const double v = std::strtod(p, &end);
    if (end == p) return numbers;
    numbers.push_back(v);
    p = end;
    while (*p == ' ' || *p == ',' || *p == '\n') ++p;
  }
}

}  // namespace gonio::camera
