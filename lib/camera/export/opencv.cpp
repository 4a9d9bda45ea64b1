// OpenCV: the file that its calibration sample writes, for cv::FileStorage.
//
// Conventions: pixel centres at integers and axes x right, y down, z forward, as here; nothing is shifted.
// distortion_coefficients in the order of cv::projectPoints, k1 k2 p1 p2 k3 [k4 k5 k6 [s1 s2 s3 s4]]; with
// fisheye_model 1 they are k1 k2 k3 k4 of cv::fisheye. extrinsic_parameters: one row per picture in image_names,
// rotation vector and translation that take world (or board) coordinates to camera coordinates.
#include "base/text.h"
#include "camera/export/formats.h"
#include "manifest/value.h"

namespace gonio::camera {
namespace {

// Six numbers a line: readers of YAML may have buffers for lines.
std::string matrix(const std::string& name, std::size_t rows, const std::vector<double>& values) {
  std::string numbers;
  for (std::size_t i = 0; i < values.size(); ++i)
    numbers += (i == 0 ? "" : i % 6 == 0 ? ",\n       " : ", ") + shortest_text(values[i]);
  return name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
         "\n   cols: " + std::to_string(rows == 0 ? 0 : values.size() / rows) + "\n   dt: d\n   data: [ " + numbers +
         " ]\n";
}

std::vector<double> coefficients(const ExportedCamera& exported) {
  const manifest::Camera& camera = exported.camera;
  std::vector<double> values;
  const auto add = [&](std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) values.push_back(lens_term(camera, name));
  };
  if (is_fisheye(camera)) {
    refuse_other_terms(exported, {"k1", "k2", "k3", "k4"}, "OpenCV");
    add({"k1", "k2", "k3", "k4"});
    return values;
  }
  refuse_other_terms(exported, {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"}, "OpenCV");
  const bool prism = any_lens_term(camera, {"s1", "s2", "s3", "s4"});
  add({"k1", "k2", "p1", "p2", "k3"});
  if (prism || any_lens_term(camera, {"k4", "k5", "k6"})) add({"k4", "k5", "k6"});
  if (prism) add({"s1", "s2", "s3", "s4"});
  return values;
}

std::string poses(const ExportedCamera& exported) {
  if (exported.views.empty()) return {};
  std::vector<double> rows;
  std::string names;
  for (const ExportedView& view : exported.views) {
    const auto camera_from_world = inverse(view.world_from_camera);
    const Vec3 r = rotation_vector_of(camera_from_world.rotation), t = camera_from_world.translation_m;
    rows.insert(rows.end(), {r.x, r.y, r.z, t.x, t.y, t.z});
    names += "   - " + manifest::print_json(manifest::Value(view.picture), -1) + "\n";
  }
  return matrix("extrinsic_parameters", exported.views.size(), rows) + "image_names:\n" + names;
}

}  // namespace

std::vector<ExportedFile> write_opencv(const std::vector<ExportedCamera>& cameras) {
  std::vector<ExportedFile> files;
  for (const ExportedCamera& exported : cameras) {
    const manifest::Camera& camera = exported.camera;
    const std::vector<double> k = {
        camera.fx_px.scalar(), 0, camera.cx_px.scalar(), 0, camera.fy_px.scalar(), camera.cy_px.scalar(), 0, 0, 1};
    std::string text = "%YAML:1.0\n---\nimage_width: " + std::to_string(camera.width_px) +
                       "\nimage_height: " + std::to_string(camera.height_px) + "\n" + matrix("camera_matrix", 3, k);
    text += "fisheye_model: " + std::to_string(is_fisheye(camera) ? 1 : 0) + "\n";
    text += matrix("distortion_coefficients", 1, coefficients(exported));
    if (camera.rms_px) text += "avg_reprojection_error: " + shortest_text(*camera.rms_px) + "\n";
    files.push_back({file_stem(exported.name) + ".yaml", text + poses(exported)});
  }
  return files;
}

}  // namespace gonio::camera
