// Blender: a Python script that adds the cameras to the open scene; the numbers stand in it as JSON.
//
// Conventions: Blender's camera looks along -z with x right and y up: world_from_camera times a half turn about x.
// With sensor_fit HORIZONTAL, fx = lens / sensor_width times the picture's width; shift_x and shift_y move the WINDOW,
// in units of the picture's width: the optical axis meets the picture at 0.5 - shift_x of the width from the left and
// at height / 2 + shift_y width / a from the top, where a = pixel_aspect_y / pixel_aspect_x = fx / fy. Edges of the
// picture lie half a pixel beyond the outer centres. Blender takes aspects of at least 1. Resolution and aspect belong
// to Blender's scene, not to a camera: a script with cameras of several sizes sets those of the first. fov = 2
// atan(width / (2 fx)) is there for reading; lens and sensor_width decide.
#include <algorithm>

#include "base/text.h"
#include "camera/export/formats.h"
#include "manifest/value.h"

namespace gonio::camera {
namespace {

using manifest::Value;

constexpr double sensor_width_mm = 36;  // Blender's own; only lens / sensor_width has a meaning

constexpr const char* head =
    R"(# Cameras for Blender: open in its text editor and run, or: blender -b scene.blend -P cameras.py
import json
import bpy
from mathutils import Quaternion

cameras = json.loads(''')";

constexpr const char* tail = R"(''')

for c in cameras:
    data = bpy.data.cameras.new(c["name"])
    data.sensor_fit = "HORIZONTAL"
    data.sensor_width = c["sensor_width_mm"]
    data.lens = c["lens_mm"]
    data.shift_x = c["shift_x"]
    data.shift_y = c["shift_y"]
    camera = bpy.data.objects.new(c["name"], data)
    camera.location = c["location"]
    camera.rotation_mode = "QUATERNION"
    camera.rotation_quaternion = Quaternion(c["rotation_quaternion"])
    bpy.context.scene.collection.objects.link(camera)

first = cameras[0]
render = bpy.context.scene.render
render.resolution_x, render.resolution_y = first["resolution"]
render.resolution_percentage = 100
render.pixel_aspect_x, render.pixel_aspect_y = first["pixel_aspect"]
bpy.context.scene.camera = bpy.data.objects[first["name"]]
)";

Value list(std::initializer_list<double> values) {
  return Value(std::vector<double>(values));
}

Value list(Vec3 v) {
  return list({v.x, v.y, v.z});
}

Value entry(const manifest::Camera& camera, const ExportedView& view) {
  const double width = camera.width_px, height = camera.height_px;
  const double fx = camera.fx_px.scalar(), fy = camera.fy_px.scalar(), aspect = fx / fy;
  const Quaternion q = view.world_from_camera.rotation * Quaternion{0, 1, 0, 0};
  const LookAt look = look_at(view);
  return Value::object({{"name", view.id},
                        {"location", list(look.eye)},
                        {"rotation_quaternion", list({q.w, q.x, q.y, q.z})},
                        {"look_at", list(look.target)},
                        {"up", list(look.up)},
                        {"fov_degrees", field_of_view_degrees(width, fx)},
                        {"sensor_width_mm", sensor_width_mm},
                        {"lens_mm", sensor_width_mm * fx / width},
                        {"shift_x", 0.5 - (camera.cx_px.scalar() + 0.5) / width},
                        {"shift_y", (camera.cy_px.scalar() + 0.5 - 0.5 * height) * aspect / width},
                        {"resolution", Value(Value::Array{Value(camera.width_px), Value(camera.height_px)})},
                        {"pixel_aspect", list({std::max(1.0, 1 / aspect), std::max(1.0, aspect)})}});
}

}  // namespace

std::vector<ExportedFile> write_blender(const std::vector<ExportedCamera>& cameras) {
  Value all = Value::array();
  for (const ExportedCamera& exported : cameras)
    for (const ExportedView& view : views_or_origin(exported)) all.push_back(entry(exported.camera, view));
  std::string numbers = manifest::print_json(all);
  for (std::size_t at = 0; (at = numbers.find('\\', at)) != std::string::npos; at += 2) numbers.insert(at, "\\");
  for (std::size_t at = 0; (at = numbers.find('\'', at)) != std::string::npos; at += 2) numbers.insert(at, "\\");
  return {{"cameras.py", head + numbers + tail}};
}

}  // namespace gonio::camera
