// The table of formats, and the manifest's side of an export.
#include "camera/export/formats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "camera/camera_model.h"
#include "camera/intrinsics.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"

namespace gonio::camera {
namespace {

constexpr std::array formats = {
    ExportFormat{"blender", "Python script: location, rotation, lens, sensor width, shift, resolution", false,
                 write_blender},
    ExportFormat{"colmap", "cameras.txt, images.txt and an empty points3D.txt", true, write_colmap},
    ExportFormat{"mitsuba", "one XML scene with a perspective sensor per picture (Mitsuba 3)", false, write_mitsuba},
    ExportFormat{"opencv", "one YAML file per camera, read by cv::FileStorage", true, write_opencv},
    ExportFormat{"pbrt", "one scene header per picture: LookAt, Camera, Film (pbrt-v4)", false, write_pbrt},
    ExportFormat{"ros", "one camera_info YAML file per camera", true, write_ros},
};

void check_names(const std::vector<std::string>& asked, const std::set<std::string>& known, const char* option) {
  for (const std::string& name : asked) {
    if (known.contains(name)) continue;
    std::string list;
    for (const std::string& k : known) list += (list.empty() ? "" : ", ") + k;
    throw Error(Exit::usage, option, "\"" + name + "\" is not in the manifest",
                list.empty() ? "it has none" : "there is " + list);
  }
}

std::optional<Rigid<frame::World, frame::Camera>> pose_of(const manifest::ImageEntry& image, bool board_frame) {
  if (!board_frame) return image.world_from_camera;
  if (!image.camera_from_board) return std::nullopt;
  const auto pose = inverse(*image.camera_from_board);
  return Rigid<frame::World, frame::Camera>{pose.rotation, pose.translation_m};
}

// lens_terms.h: 0 is the perspective view, 1 the equidistant one.
double fisheye_share(const manifest::Camera& camera) {
  return camera.distortion.contains("fisheye") ? lens_term(camera, "fisheye") : camera.model == "fisheye" ? 1 : 0;
}

void check_lens(const ExportedCamera& camera, const ExportFormat& format) {
  const std::string model_place = camera.place + "/model";
  if (!camera_model_info(camera.camera.model, camera.place).perspective)
    throw Error(Exit::data, model_place, "\"" + camera.camera.model + "\" is no perspective camera",
                "only perspective cameras are exported");
  if (camera.camera.width_px <= 0 || camera.camera.height_px <= 0)
    throw Error(Exit::data, camera.place + (camera.camera.width_px <= 0 ? "/width_px" : "/height_px"),
                "the image has no pixels", "give the size of the image in pixels");
  intrinsics_of(camera.camera, camera.place);  // refuses what is missing or impossible
  const double fisheye = fisheye_share(camera.camera);
  if (format.lens && fisheye != 0 && fisheye != 1)
    throw Error(Exit::data, camera.place + "/distortion/fisheye",
                "is " + shortest_text(fisheye) + "; other programs know 0 and 1 only", "run develop --undistort");
  if (format.lens) return;
  std::string at = fisheye != 0 ? model_place : "";
  for (const auto& [name, parameter] : camera.camera.distortion)
    if (at.empty() && lens_term(camera.camera, name) != 0) at = camera.place + "/distortion/" + name;
  if (!at.empty())
    throw Error(Exit::data, at, std::string(format.name) + " has no lens distortion",
                "run develop --undistort and export the camera that it writes, or give --undistorted where your "
                "pictures have none any more");
}

bool took(const manifest::Document& document, const std::string& camera, const manifest::ImageEntry& image) {
  return image.camera == camera || (image.camera.empty() && document.cameras.size() == 1);
}

bool wanted(const std::vector<std::string>& list, const std::string& name) {
  return list.empty() || std::ranges::find(list, name) != list.end();
}

// Those that are named; else those that took the images, so that a camera whose pictures have been undistorted into
// another one is left alone; all where there are no images.
bool is_asked_for(const manifest::Document& document, const std::string& camera, const ExportRequest& request) {
  if (!request.cameras.empty()) return wanted(request.cameras, camera);
  return document.images.empty() || std::ranges::any_of(document.images, [&](const manifest::ImageEntry& image) {
           return took(document, camera, image) && wanted(request.images, image.id);
         });
}

std::string picture_of(const manifest::Document& document, const manifest::ImageEntry& image) {
  const auto file = document.files.find(image.file);
  return file == document.files.end() ? image.id : std::filesystem::path(file->second.path).filename().string();
}

}  // namespace

std::span<const ExportFormat> export_formats() {
  return formats;
}

std::vector<ExportedFile> export_cameras(const manifest::Document& document, const ExportRequest& request) {
  const auto format = std::ranges::find(formats, std::string_view(request.format), &ExportFormat::name);
  if (format == formats.end()) throw Error(Exit::usage, "--to", "\"" + request.format + "\" is no format");
  std::set<std::string> names, images;
  for (const auto& [name, camera] : document.cameras) names.insert(name);
  for (const auto& image : document.images) images.insert(image.id);
  check_names(request.cameras, names, "--camera");
  check_names(request.images, images, "--image");
  if (names.empty())
    throw Error(Exit::data, manifest::place(document, "/cameras"), "empty", "calibrate a camera first");
  std::vector<ExportedCamera> cameras;
  for (const auto& [name, camera] : document.cameras) {
    if (!is_asked_for(document, name, request)) continue;
    ExportedCamera exported{name, manifest::place(document, "/cameras/" + name), camera, {}};
    if (request.undistorted) {
      exported.camera.model = "pinhole";
      exported.camera.distortion.clear();
    }
    check_lens(exported, *format);
    for (const auto& image : document.images) {
      const auto pose = pose_of(image, request.board_frame);
      if (took(document, name, image) && pose && wanted(request.images, image.id))
        exported.views.push_back({image.id, picture_of(document, image), *pose});
    }
    cameras.push_back(std::move(exported));
  }
  return format->write(cameras);
}

double lens_term(const manifest::Camera& camera, std::string_view name) {
  const auto found = camera.distortion.find(std::string(name));
  return found == camera.distortion.end() || !found->second.given() ? 0 : found->second.scalar();
}

bool is_fisheye(const manifest::Camera& camera) {
  return fisheye_share(camera) == 1;
}

bool any_lens_term(const manifest::Camera& camera, std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(names, [&](std::string_view name) { return lens_term(camera, name) != 0; });
}

void refuse_other_terms(const ExportedCamera& camera, std::initializer_list<std::string_view> known,
                        std::string_view program) {
  for (const auto& [name, parameter] : camera.camera.distortion) {
    const bool held = std::ranges::find(known, std::string_view(name)) != known.end();
    if (held || name == "fisheye" || lens_term(camera.camera, name) == 0) continue;
    throw Error(Exit::data, camera.place + "/distortion/" + name,
                std::string(program) + " has no term " + name + " in a " + camera.camera.model + " lens",
                "calibrate with a model that it has, or run develop --undistort");
  }
}

std::string joined(std::span<const double> numbers, std::string_view separator) {
  std::string text;
  for (const double v : numbers) text += (text.empty() ? "" : std::string(separator)) + shortest_text(v);
  return text;
}

std::vector<ExportedView> views_or_origin(const ExportedCamera& camera) {
  if (!camera.views.empty()) return camera.views;
  return {{camera.name, camera.name, {}}};
}

LookAt look_at(const ExportedView& view) {
  const auto& pose = view.world_from_camera;
  return {pose.translation_m, pose * Vec3{0, 0, 1}, pose.rotate({0, -1, 0})};
}

double field_of_view_degrees(double extent_px, double focal_px) {
  return 2 * std::atan(extent_px / (2 * focal_px)) * 180 / pi;
}

}  // namespace gonio::camera
