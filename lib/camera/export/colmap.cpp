// COLMAP: a text model, cameras.txt, images.txt, points3D.txt (colmap.github.io/format.html).
//
// Conventions: axes x right, y down, z forward as here, but the centre of the top-left pixel is (0.5, 0.5): half a
// pixel is added to the principal point. images.txt holds camera_from_world as QW QX QY QZ TX TY TZ, and a second line
// per picture with its points, which is empty. Models: SIMPLE_PINHOLE f cx cy; PINHOLE fx fy cx cy; OPENCV with k1 k2
// p1 p2; FULL_OPENCV with k1 k2 p1 p2 k3 k4 k5 k6; OPENCV_FISHEYE with k1 k2 k3 k4: the simplest that holds the camera
// exactly.
#include "base/error.h"
#include "base/text.h"
#include "camera/export/formats.h"

namespace gonio::camera {
namespace {

std::string camera_line(const ExportedCamera& exported, std::size_t id) {
  const manifest::Camera& camera = exported.camera;
  const double fx = camera.fx_px.scalar(), fy = camera.fy_px.scalar();
  std::vector<double> values = {fx, fy, camera.cx_px.scalar() + 0.5, camera.cy_px.scalar() + 0.5};
  const auto add = [&](std::initializer_list<std::string_view> names) {
    refuse_other_terms(exported, names, "COLMAP");
    for (const std::string_view name : names) values.push_back(lens_term(camera, name));
  };
  std::string model = fx == fy ? "SIMPLE_PINHOLE" : "PINHOLE";
  if (is_fisheye(camera)) {
    model = "OPENCV_FISHEYE";
    add({"k1", "k2", "k3", "k4"});
  } else if (any_lens_term(camera, {"k3", "k4", "k5", "k6"})) {
    model = "FULL_OPENCV";
    add({"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"});
  } else if (any_lens_term(camera, {"k1", "k2", "p1", "p2"})) {
    model = "OPENCV";
    add({"k1", "k2", "p1", "p2"});
  } else {
    refuse_other_terms(exported, {}, "COLMAP");
    if (fx == fy) values.erase(values.begin());
  }
  return std::to_string(id) + " " + model + " " + std::to_string(camera.width_px) + " " +
         std::to_string(camera.height_px) + " " + joined(values, " ") + "\n";
}

}  // namespace

std::vector<ExportedFile> write_colmap(const std::vector<ExportedCamera>& cameras) {
  std::string lines = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  std::string images = "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)\n";
  std::size_t image_id = 0;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    lines += camera_line(cameras[k], k + 1);
    for (const ExportedView& view : cameras[k].views) {
      if (view.picture.find_first_of(" \t\n") != std::string::npos)
        throw Error(Exit::data, cameras[k].place, "took \"" + view.picture + "\"; COLMAP's names end at a blank",
                    "rename the picture");
      const auto pose = inverse(view.world_from_camera);
      const std::vector<double> values = {pose.rotation.w,     pose.rotation.x,      pose.rotation.y,
                                          pose.rotation.z,     pose.translation_m.x, pose.translation_m.y,
                                          pose.translation_m.z};
      images += std::to_string(++image_id) + " " + joined(values, " ") + " " + std::to_string(k + 1) + " " +
                view.picture + "\n\n";
    }
  }
  return {{"cameras.txt", lines}, {"images.txt", images}, {"points3D.txt", "# no points\n"}};
}

}  // namespace gonio::camera
