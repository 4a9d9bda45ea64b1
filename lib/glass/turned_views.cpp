// See turned_views.h.
#include "glass/turned_views.h"

#include <algorithm>

#include "base/atomic_file.h"
#include "base/text.h"
#include "glass/tensors.h"
#include "io/picture.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"

namespace gonio::glass {
namespace {

namespace fs = std::filesystem;

std::vector<double> list(Vec3 v) {
  return {v.x, v.y, v.z};
}

void add_screen(manifest::Document& document, const Cell& cell, const std::string& id,
                const Rigid<frame::Object, frame::World>& object_from_world) {
  manifest::Light screen = cell.scene.lights.at("screen");
  manifest::Parameters& p = screen.parameters;
  p["position_m"] = list(object_from_world * p.at("position_m").vector());
  for (const char* direction : {"direction", "up"})
    p[direction] = list(object_from_world.rotate(p.at(direction).vector()));
  screen.file = manifest::add_file(document, manifest::resolve(cell.scene, screen.file, "/lights/screen"), "shows");
  document.lights[id] = screen;
}

std::string add_mask(manifest::Document& document, const GlassSet& set, const Cell& cell, const fs::path& path) {
  const std::vector<float> mask = tensors_of(set, cell).at("mask");
  io::Image picture(set.wish().width_px, set.wish().height_px, {"Y"});
  picture.data = mask;
  io::write_picture(path, picture);
  return manifest::add_file(document, path, path.stem().string());
}

}  // namespace

manifest::Document turned_views(const GlassSet& set, std::size_t object) {
  manifest::Document document;
  document.folder = set.folder();
  const fs::path masks = set.folder() / "masks";
  make_folder(masks);
  document.meshes["table"].plane_size_m = {0.3, 0.3};
  document.surfaces["table"].parameters["albedo"] = 0.3;  // of each view another; about so light in the mean
  manifest::Object table{.id = "table", .mesh = "table", .surface = "table", .world_from_object = {}};
  for (std::size_t v = 0; v < set.wish().views; ++v) {
    Cell cell = set.cell(object * set.wish().views + v);
    std::erase_if(cell.scene.images, [](const manifest::ImageEntry& i) { return i.id != "bare"; });
    const auto& objects = cell.scene.objects;
    const auto glass = std::ranges::find(objects, std::string("object"), &manifest::Object::id);
    const auto object_from_world = inverse(Rigid<frame::World, frame::Object>(*glass->world_from_object));
    table.world_from_object.emplace().translation_m = {0, 0, -glass->world_from_object->translation_m.z};
    const std::string id = format("view-%zu", v);
    document.cameras[id] = cell.scene.cameras.at("camera");
    add_screen(document, cell, "screen-" + std::to_string(v), object_from_world);
    manifest::ImageEntry image = cell.scene.images.front();
    image.id = image.camera = id;
    image.light = {"screen-" + std::to_string(v)};
    const Rigid<frame::World, frame::Camera> pose = *image.world_from_camera;
    image.world_from_camera->rotation = normalized(object_from_world.rotation * pose.rotation);
    image.world_from_camera->translation_m = object_from_world * pose.translation_m;
    image.file = manifest::add_file(document, set.folder_of(cell) / "bare-mosaic.exr", id);
    image.mask = add_mask(document, set, cell, masks / format("%zu-%zu.png", object, v));
    document.images.push_back(std::move(image));
  }
  document.objects.push_back(table);
  return document;
}

}  // namespace gonio::glass
