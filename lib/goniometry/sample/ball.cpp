// A sphere of a surface, path traced: a small distant-looking lamp high on the left, a dim sky all around.
#include "base/error.h"
#include "camera/intrinsics.h"
#include "goniometry/outputs.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/file.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/looking_at.h"
#include "render/path_tracer.h"

namespace gonio::goniometry {

io::Image sphere_picture(const manifest::Document& document, const std::string& surface, int pixels) {
  manifest::Document scene;
  scene.name = "sphere";
  scene.folder = document.folder;
  scene.allow_outside = true;  // the table of a reconstruction lies where the user wanted it
  scene.files = document.files;
  scene.surfaces["sphere"] = document.surfaces.at(surface);
  scene.meshes["sphere"].sphere_radius_m = 0.05;
  scene.objects.push_back({.id = "sphere", .mesh = "sphere", .surface = "sphere", .world_from_object = {}});
  manifest::Light& lamp = scene.lights["lamp"];
  lamp.model = "sphere";
  lamp.parameters = {{"position_m", std::vector<double>{-0.9, -1.2, 1.1}}, {"watt_per_sr", 4.0}, {"radius_m", 0.08}};
  manifest::Light& sky = scene.lights["sky"];
  sky.model = "uniform";
  sky.parameters = {{"radiance", 0.12}};
  camera::enter_pinhole(scene, "camera", pixels, pixels, 3.6 * pixels);
  const auto pose = render::looking_at({0, -0.41, 0.08}, {0, 0, 0});
  manifest::enter_image(scene, {.id = "sphere", .camera = "camera", .world_from_camera = {pose, {}}});
  const scene::Scene built = scene::build_scene(scene);
  const render::RayCaster caster(built.instances);
  return render::render(built, 0, caster, {.spp = 64, .seed = 1, .geometry = false});
}

}  // namespace gonio::goniometry
