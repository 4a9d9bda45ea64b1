// Exports for renderers, held against those programs' own mathematics, written from their documentation and not from
// the writers: Mitsuba's perspective sensor, pbrt's perspective camera, Blender's view plane.
#include <cstdlib>

#include "export_cases.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/value.h"

namespace gonio::camera {
namespace {

// Rows of a camera_from_world rotation and the eye.
struct Axes {
  Vec3 x, y, z, eye;
  Vec3 to_camera(Vec3 p) const { return {dot(x, p - eye), dot(y, p - eye), dot(z, p - eye)}; }
};

Vec3 vec(const std::vector<double>& v, std::size_t first = 0) {
  return {v.at(first), v.at(first + 1), v.at(first + 2)};
}

// Mitsuba's Transform::look_at: dir = target - origin, left = up x dir, new_up = dir x left; columns left, new_up, dir.
// perspective_projection: clip = cot(fov / 2) (x / z, y / z), film = (1 - clip_x) / 2, (1 - aspect clip_y) / 2. A ray
// of film position s starts at s + principal_point_offset, so a point is seen where that sum is its projection.
Vec2 mitsuba(const std::string& xml, Vec3 p) {
  const auto value = [&](const std::string& name) {
    return numbers_after(xml, "value", xml.find("name=\"" + name + "\"")).at(0);
  };
  const Vec3 eye = vec(numbers_after(xml, "origin")), up = vec(numbers_after(xml, " up"));
  const Vec3 forward = normalized(vec(numbers_after(xml, "target")) - eye);
  const Vec3 left = normalized(cross(up, forward));
  const Vec3 c = Axes{left, cross(forward, left), forward, eye}.to_camera(p);
  EXPECT_GT(c.z, 0);
  const double width = value("width"), height = value("height");
  const double cot = 1 / std::tan(value("fov") * pi / 360);
  const double film_x = 0.5 * (1 - cot * c.x / c.z) - value("principal_point_offset_x");
  const double film_y = 0.5 * (1 - width / height * cot * c.y / c.z) - value("principal_point_offset_y");
  return {film_x * width - 0.5, film_y * height - 0.5};
}

TEST(ExportMitsuba, PointsLandOnTheirPixels) {
  const manifest::Document document = exported_document(true);
  const auto files = export_cameras(document, {.format = "mitsuba"});
  ASSERT_EQ(files.size(), 3u);
  for (const char* id : {"v0", "v1", "v2"})
    expect_same_pixels(document, id, [&](Vec3 p) { return mitsuba(content_of(files, std::string(id) + ".xml"), p); });
}

TEST(ExportMitsuba, RefusesPixelsThatAreNotSquare) {
  EXPECT_THROW(export_cameras(exported_document(false), {.format = "mitsuba"}), Error);
}

// pbrt-v4's LookAt: right = normalize(up) x dir, newUp = dir x right; rows of camera_from_world. Scale multiplies from
// the left: it stands before LookAt in the file. Perspective divides by z and by tan(fov / 2); rasterFromScreen as in
// ProjectiveCamera, y turned.
Vec2 pbrt(const std::string& scene, Vec3 p) {
  const auto look = numbers_after(scene, "LookAt");
  EXPECT_EQ(look.size(), 9u);
  EXPECT_LT(scene.find("Scale"), scene.find("LookAt"));
  const Vec3 scale = vec(numbers_after(scene, "Scale")), eye = vec(look);
  const Vec3 dir = normalized(vec(look, 3) - eye), right = normalized(cross(normalized(vec(look, 6)), dir));
  const Vec3 c = scale * Axes{right, cross(dir, right), dir, eye}.to_camera(p);
  EXPECT_GT(c.z, 0);
  const double tangent = std::tan(numbers_after(scene, "float fov\"").at(0) * pi / 360);
  const double screen_x = c.x / c.z / tangent, screen_y = c.y / c.z / tangent;
  const auto window = numbers_after(scene, "float screenwindow\"");  // x min, x max, y min, y max
  const double width = numbers_after(scene, "xresolution\"").at(0),
               height = numbers_after(scene, "yresolution\"").at(0);
  const double raster_x = width * (screen_x - window.at(0)) / (window.at(1) - window.at(0));
  const double raster_y = -height * (screen_y - window.at(3)) / (window.at(3) - window.at(2));
  return {raster_x - 0.5, raster_y - 0.5};
}

TEST(ExportPbrt, PointsLandOnTheirPixels) {
  for (const bool square : {true, false}) {
    const manifest::Document document = exported_document(square);
    const auto files = export_cameras(document, {.format = "pbrt"});
    ASSERT_EQ(files.size(), 3u);
    for (const char* id : {"v0", "v1", "v2"})
      expect_same_pixels(document, id, [&](Vec3 p) { return pbrt(content_of(files, std::string(id) + ".pbrt"), p); });
  }
}

// A centred camera with square pixels has the screen window that pbrt would choose: -1 to 1 along the shorter side.
TEST(ExportPbrt, FieldOfViewBelongsToTheShorterSide) {
  manifest::Document document;
  manifest::Camera c = far_off_centre(true);
  c.cx_px = 319.5;
  c.cy_px = 199.5;
  document.cameras["c"] = c;
  const std::string scene = content_of(export_cameras(document, {.format = "pbrt"}), "c.pbrt");
  EXPECT_NEAR(numbers_after(scene, "float fov\"").at(0), 2 * std::atan(200 / 512.25) * 180 / pi, 1e-9);
  EXPECT_THAT(numbers_after(scene, "float screenwindow\""),
              testing::Pointwise(testing::DoubleNear(1e-9), {-1.6, 1.6, -1.0, 1.0}));
}

// BKE_camera_params_compute_viewplane with sensor_fit horizontal, at clip distance 1: x from -w/2 to w/2, y from
// -ycor h/2 to ycor h/2, both moved by shift times w, all times sensor / (lens w).
Vec2 blender(const manifest::Value& c, Vec3 p) {
  const auto number = [&](const char* key) { return c.find(key)->as_number(); };
  const auto item = [&](const char* key, std::size_t i) { return c.find(key)->as_array().at(i).as_number(); };
  const Quaternion q{item("rotation_quaternion", 0), item("rotation_quaternion", 1), item("rotation_quaternion", 2),
                     item("rotation_quaternion", 3)};
  const Vec3 eye{item("location", 0), item("location", 1), item("location", 2)};
  const Vec3 v = transposed(matrix_of(q)) * (p - eye);  // x right, y up, looking along -z
  EXPECT_LT(v.z, 0);
  const double width = item("resolution", 0), height = item("resolution", 1);
  const double ycor = item("pixel_aspect", 1) / item("pixel_aspect", 0);
  EXPECT_GE(std::min(item("pixel_aspect", 0), item("pixel_aspect", 1)), 1);
  const double pixel = number("sensor_width_mm") / number("lens_mm") / width;
  const double x_min = pixel * (-0.5 * width + number("shift_x") * width), x_size = pixel * width;
  const double y_min = pixel * (-0.5 * ycor * height + number("shift_y") * width), y_size = pixel * ycor * height;
  const double x = (v.x / -v.z - x_min) / x_size * width, y_from_below = (v.y / -v.z - y_min) / y_size * height;
  return {x - 0.5, height - y_from_below - 0.5};
}

TEST(ExportBlender, PointsLandOnTheirPixels) {
  for (const bool square : {true, false}) {
    const manifest::Document document = exported_document(square);
    const std::string script = content_of(export_cameras(document, {.format = "blender"}), "cameras.py");
    const std::size_t first = script.find("'''") + 3, last = script.find("'''", first);
    const manifest::Value cameras = manifest::parse_json(script.substr(first, last - first), "cameras.py");
    ASSERT_EQ(cameras.as_array().size(), 3u);
    for (const manifest::Value& c : cameras.as_array())
      expect_same_pixels(document, c.find("name")->as_string(), [&](Vec3 p) { return blender(c, p); });
  }
}

TEST(Export, RenderersRefuseALensUnlessItIsGone) {
  manifest::Document document = exported_document(true);
  document.cameras["wide"].model = "radial-tangential";
  document.cameras["wide"].distortion["k1"] = -0.2;
  for (const char* format : {"mitsuba", "pbrt", "blender"}) {
    try {
      export_cameras(document, {.format = format});
      ADD_FAILURE() << format;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::data);
      EXPECT_EQ(e.place(), "t#/cameras/wide/distortion/k1");
      EXPECT_THAT(e.remedy(), testing::HasSubstr("develop --undistort"));
    }
    EXPECT_FALSE(export_cameras(document, {.format = format, .undistorted = true}).empty());
    EXPECT_FALSE(export_cameras(document, {.format = format, .cameras = {"tall"}}).empty());
  }
}

TEST(Export, RefusesWhatCannotBeExported) {
  const manifest::Document good = exported_document(true);
  EXPECT_THROW(export_cameras({}, {.format = "opencv"}), Error);
  EXPECT_THROW(export_cameras(good, {.format = "opencv", .cameras = {"absent"}}), Error);
  EXPECT_THROW(export_cameras(good, {.format = "opencv", .images = {"absent"}}), Error);
  manifest::Document bad = good;
  bad.cameras["wide"].model = "orthographic";
  EXPECT_THROW(export_cameras(bad, {.format = "opencv"}), Error);
  bad = good;
  bad.cameras["wide"].fx_px = {};
  EXPECT_THROW(export_cameras(bad, {.format = "opencv"}), Error);
  bad = good;
  bad.cameras["wide"].width_px = 0;
  EXPECT_THROW(export_cameras(bad, {.format = "pbrt"}), Error);
}

TEST(Export, CameraWithoutPosesStandsAtTheOrigin) {
  manifest::Document document = exported_document(true);
  keep_images(document, {});
  for (const char* format : {"mitsuba", "pbrt"}) EXPECT_EQ(export_cameras(document, {.format = format}).size(), 2u);
}

}  // namespace
}  // namespace gonio::camera
