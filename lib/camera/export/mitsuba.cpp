// Mitsuba 3: a scene with one `perspective` sensor per picture.
//
// Conventions: the sensor looks along +z with x to the LEFT and y up (world_from_camera times a half turn about z);
// `lookat` builds left = up x forward, so the scene stays right-handed and nothing is mirrored. Film coordinates run
// from 0 to 1 with pixel centres at (i + 0.5) / n. principal_point_offset is added to the film position before the ray
// is formed, so the optical axis meets the film at 0.5 - offset: offset_x = 0.5 - (cx + 0.5) / width, the same in y.
// fov belongs to the axis that fov_axis names: 2 atan(width / (2 f)). Pixels are square, and a scale in to_world is
// refused by Mitsuba: cameras whose fx and fy differ by more than 0.05 px over the picture cannot be written.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "camera/export/formats.h"

namespace gonio::camera {
namespace {

constexpr double largest_error_px = 0.05;

void check_square(const ExportedCamera& exported) {
  const manifest::Camera& camera = exported.camera;
  const double ratio = camera.fy_px.scalar() / camera.fx_px.scalar(), cy = camera.cy_px.scalar();
  const double error_px = std::abs(ratio - 1) * std::max(std::abs(cy + 0.5), std::abs(camera.height_px - 0.5 - cy));
  if (error_px <= largest_error_px) return;
  throw Error(Exit::data, exported.place + "/fy_px",
              "differs from fx_px, and Mitsuba's pixels are square (" +
                  shortest_text(std::round(error_px * 100) / 100) + " px at the picture's border)",
              "run develop --undistort, whose cameras have square pixels, or calibrate with equal focal lengths");
}

std::string numbers(Vec3 v) {
  const std::array values{v.x, v.y, v.z};
  return joined(values, ", ");
}

std::string scene(const manifest::Camera& camera, const ExportedView& view) {
  const LookAt look = look_at(view);
  const auto number = [](const char* name, double value) {
    return std::string("    <float name=\"") + name + "\" value=\"" + shortest_text(value) + "\"/>\n";
  };
  return "<scene version=\"3.0.0\">\n  <sensor type=\"perspective\">\n    <string name=\"fov_axis\" value=\"x\"/>\n" +
         number("fov", field_of_view_degrees(camera.width_px, camera.fx_px.scalar())) +
         number("principal_point_offset_x", 0.5 - (camera.cx_px.scalar() + 0.5) / camera.width_px) +
         number("principal_point_offset_y", 0.5 - (camera.cy_px.scalar() + 0.5) / camera.height_px) +
         "    <transform name=\"to_world\">\n      <lookat origin=\"" + numbers(look.eye) + "\" target=\"" +
         numbers(look.target) + "\" up=\"" + numbers(look.up) +
         "\"/>\n    </transform>\n    <film type=\"hdrfilm\">\n      <integer name=\"width\" value=\"" +
         std::to_string(camera.width_px) + "\"/>\n      <integer name=\"height\" value=\"" +
         std::to_string(camera.height_px) + "\"/>\n      <rfilter type=\"box\"/>\n    </film>\n  </sensor>\n</scene>\n";
}

}  // namespace

std::vector<ExportedFile> write_mitsuba(const std::vector<ExportedCamera>& cameras) {
  std::vector<ExportedFile> files;
  for (const ExportedCamera& exported : cameras) {
    check_square(exported);
    for (const ExportedView& view : views_or_origin(exported))
      files.push_back({file_stem(view.id) + ".xml", scene(exported.camera, view)});
  }
  return files;
}

}  // namespace gonio::camera
