// See specimen_mirror_ball.h.
#include "render/specimen_mirror_ball.h"

#include "base/atomic_file.h"
#include "camera/intrinsics.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/looking_at.h"
#include "render/specimen_camera.h"
#include "render/specimen_glass.h"

namespace gonio::render {

manifest::Document mirror_ball_specimen(const std::filesystem::path& out) {
  make_folder(out);
  io::write_picture(out / "sky.exr", sky_with_windows());
  manifest::Document document;
  manifest::Light& sky = document.lights["sky"];
  sky.model = "lat-long";
  sky.file = manifest::add_file(document, out / "sky.exr", "sky");
  document.meshes["ball"].sphere_radius_m = 0.03;
  manifest::Surface& chromium = document.surfaces["chromium"];  // Johnson & Christy 1974, reduced to red, green, blue
  chromium.model = "conductor";
  chromium.parameters = {
      {"eta", std::vector<double>{3.219, 3.054, 2.37}}, {"k", std::vector<double>{3.31, 3.314, 3.141}}, {"alpha", 0.0}};
  manifest::Object ball{.id = "ball", .mesh = "ball", .surface = "chromium", .world_from_object = {}};
  ball.world_from_object.emplace();
  document.objects.push_back(ball);
  camera::enter_pinhole(document, "camera", 320, 320, 900);
  add_view(document, {.id = "front", .world_from_camera = {looking_at({-0.32, 0.0, 0.08}, {}), {}}});
  add_view(document, {.id = "left", .world_from_camera = {looking_at({0.16, 0.28, 0.06}, {}), {}}});
  add_view(document, {.id = "right", .world_from_camera = {looking_at({0.14, -0.28, 0.10}, {}), {}}});
  return document;
}

}  // namespace gonio::render
