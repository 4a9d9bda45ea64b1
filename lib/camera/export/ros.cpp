// ROS: sensor_msgs/CameraInfo as the YAML file of camera_calibration_parsers and camera_info_manager.
//
// Conventions: pixel centres at integers, optical frame x right, y down, z forward (REP 103, 104), as here. D in
// OpenCV's order: plumb_bob k1 k2 p1 p2 k3, rational_polynomial with k4 k5 k6, equidistant k1 k2 k3 k4
// (Kannala-Brandt). R is the identity and P = [K | 0]: one camera alone, rectified into its own focal lengths and
// principal point. Thin-prism terms do not exist. What it does not do: the baseline of a stereo pair in P.
#include <array>

#include "base/text.h"
#include "camera/export/formats.h"

namespace gonio::camera {
namespace {

std::string matrix(const std::string& name, int rows, int columns, std::span<const double> values) {
  return name + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) + "\n  data: [" +
         joined(values, ", ") + "]\n";
}

struct Distortion {
  std::string model;
  std::vector<double> values;
};

Distortion distortion_of(const ExportedCamera& exported) {
  Distortion d;
  const auto take = [&](std::initializer_list<std::string_view> names) {
    refuse_other_terms(exported, names, "ROS");
    for (const std::string_view name : names) d.values.push_back(lens_term(exported.camera, name));
  };
  if (is_fisheye(exported.camera)) {
    d.model = "equidistant";
    take({"k1", "k2", "k3", "k4"});
  } else if (any_lens_term(exported.camera, {"k4", "k5", "k6"})) {
    d.model = "rational_polynomial";
    take({"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"});
  } else {
    d.model = "plumb_bob";
    take({"k1", "k2", "p1", "p2", "k3"});
  }
  return d;
}

}  // namespace

std::vector<ExportedFile> write_ros(const std::vector<ExportedCamera>& cameras) {
  std::vector<ExportedFile> files;
  for (const ExportedCamera& exported : cameras) {
    const manifest::Camera& camera = exported.camera;
    const double fx = camera.fx_px.scalar(), fy = camera.fy_px.scalar();
    const double cx = camera.cx_px.scalar(), cy = camera.cy_px.scalar();
    const Distortion d = distortion_of(exported);
    const std::array k{fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0};
    const std::array r{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const std::array p{fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0};
    std::string text = "image_width: " + std::to_string(camera.width_px) +
                       "\nimage_height: " + std::to_string(camera.height_px) +
                       "\ncamera_name: " + file_stem(exported.name) + "\n" + matrix("camera_matrix", 3, 3, k) +
                       "distortion_model: " + d.model + "\n";
    text += matrix("distortion_coefficients", 1, static_cast<int>(d.values.size()), d.values) +
            matrix("rectification_matrix", 3, 3, r) + matrix("projection_matrix", 3, 4, p);
    files.push_back({file_stem(exported.name) + ".yaml", text});
  }
  return files;
}

}  // namespace gonio::camera
