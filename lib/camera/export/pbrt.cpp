// pbrt-v4: the head of a scene per picture, to be followed by WorldBegin.
//
// Conventions: pbrt's camera looks along +z with x right and y up, a left-handed frame, and its LookAt takes the world
// as left-handed, too: right = up x forward would mirror a right-handed world. `Scale -1 1 1` before it undoes that;
// shapes are not touched, because WorldBegin resets the transform. fov is the angle of the screen from -1 to 1, which
// is that of the SHORTER side of the picture; screenwindow xmin xmax ymin ymax says which part of that plane the film
// covers, and so holds the principal point and two focal lengths: raster x = (s - xmin) / (xmax - xmin) width, raster y
// = (ymax - s) / (ymax - ymin) height. Raster coordinates have pixel centres at i + 0.5.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "camera/export/formats.h"

namespace gonio::camera {
namespace {

std::string numbers(Vec3 v) {
  const std::array values{v.x, v.y, v.z};
  return joined(values, " ");
}

std::string scene(const manifest::Camera& camera, const ExportedView& view) {
  const double width = camera.width_px, height = camera.height_px;
  const double fx = camera.fx_px.scalar(), fy = camera.fy_px.scalar();
  const double unit = std::min(0.5 * width / fx, 0.5 * height / fy);  // tangent at screen coordinate 1
  const double span_x = width / (fx * unit), span_y = height / (fy * unit);
  const double x_min = -(camera.cx_px.scalar() + 0.5) / width * span_x;
  const double y_max = (camera.cy_px.scalar() + 0.5) / height * span_y;
  const std::array window{x_min, x_min + span_x, y_max - span_y, y_max};
  const LookAt look = look_at(view);
  return "Scale -1 1 1\nLookAt " + numbers(look.eye) + "  " + numbers(look.target) + "  " + numbers(look.up) +
         "\nCamera \"perspective\" \"float fov\" [ " + shortest_text(2 * std::atan(unit) * 180 / pi) +
         " ] \"float screenwindow\" [ " + joined(window, " ") + " ]\nFilm \"rgb\" \"integer xresolution\" [ " +
         std::to_string(camera.width_px) + " ] \"integer yresolution\" [ " + std::to_string(camera.height_px) +
         " ] \"string filename\" \"" + file_stem(view.id) + ".exr\"\nPixelFilter \"box\"\n";
}

}  // namespace

std::vector<ExportedFile> write_pbrt(const std::vector<ExportedCamera>& cameras) {
  std::vector<ExportedFile> files;
  for (const ExportedCamera& exported : cameras)
    for (const ExportedView& view : views_or_origin(exported))
      files.push_back({file_stem(view.id) + ".pbrt", scene(exported.camera, view)});
  return files;
}

}  // namespace gonio::camera
