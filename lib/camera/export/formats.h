// Calibrated cameras as files of other programs. One source per format, each with that program's conventions at its
// head; the table of them is in formats.cpp. What is written follows from a camera's terms by name, never by place.
//
// Here: pixel centres at integers, camera axes x right, y down, z forward, world_from_camera in metres.
#pragma once
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geom/rigid.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/forward.h"

namespace gonio::camera {

struct ExportedView {  // a picture whose pose is known
  std::string id;
  std::string picture;  // name of its file without folders, or its id
  Rigid<frame::World, frame::Camera> world_from_camera;
};
struct ExportedCamera {
  std::string name, place;  // place: for messages
  manifest::Camera camera;
  std::vector<ExportedView> views;
};
struct ExportedFile {
  std::string name, content;
};
struct ExportFormat {
  std::string_view name, sentence;
  bool lens = false;  // can hold lens distortion
  std::vector<ExportedFile> (*write)(const std::vector<ExportedCamera>&) = nullptr;
};
std::span<const ExportFormat> export_formats();

struct ExportRequest {
  std::string format;
  std::vector<std::string> cameras{}, images{};  // empty: all images, and the cameras that took them
  bool board_frame = false;  // poses against the board that a picture shows, instead of world_from_camera
  bool undistorted = false;  // the pictures have no distortion any more: leave the lens away
};
// Error(usage) for names that do not exist; Error(data) for cameras that the format cannot hold, saying what to do.
std::vector<ExportedFile> export_cameras(const manifest::Document& document, const ExportRequest& request);

// Helpers of the writers.
double lens_term(const manifest::Camera& camera, std::string_view name);  // 0 where left out
bool is_fisheye(const manifest::Camera& camera);  // Kannala-Brandt: angles, not tangents, are distorted
bool any_lens_term(const manifest::Camera& camera, std::initializer_list<std::string_view> names);
// Error(data) at the first term that is not zero and none of `known`.
void refuse_other_terms(const ExportedCamera& camera, std::initializer_list<std::string_view> known,
                        std::string_view program);
std::string joined(std::span<const double> numbers, std::string_view separator);
// Renderers draw from somewhere: the camera's views, or one at the world's origin where it has none.
std::vector<ExportedView> views_or_origin(const ExportedCamera& camera);

// Eye, a point straight ahead at 1 m, and the direction of the picture's top, in world coordinates.
struct LookAt {
  Vec3 eye, target, up;
};
LookAt look_at(const ExportedView& view);
double field_of_view_degrees(double extent_px, double focal_px);  // 2 atan(w / (2 f))

std::vector<ExportedFile> write_blender(const std::vector<ExportedCamera>& cameras);
std::vector<ExportedFile> write_colmap(const std::vector<ExportedCamera>& cameras);
std::vector<ExportedFile> write_mitsuba(const std::vector<ExportedCamera>& cameras);
std::vector<ExportedFile> write_opencv(const std::vector<ExportedCamera>& cameras);
std::vector<ExportedFile> write_pbrt(const std::vector<ExportedCamera>& cameras);
std::vector<ExportedFile> write_ros(const std::vector<ExportedCamera>& cameras);

}  // namespace gonio::camera
