// See board_place.h.
#include "camera/board_place.h"

#include <algorithm>

#include "manifest/document.h"
#include "manifest/measured_views.h"
#include "manifest/sections/frame_link.h"
#include "manifest/sections/image.h"
#include "manifest/sections/object.h"

namespace gonio::camera {

std::optional<Rigid<frame::World, frame::Board>> world_from_board(const manifest::Document& document,
                                                                  const std::string& board) {
  for (const manifest::Link& link : document.frames) {
    const auto object = std::ranges::find(document.objects, link.to, &manifest::Object::id);
    if (link.from != board || object == document.objects.end()) continue;
    const Rigid<frame::Object, frame::Board> object_from_board{link.rotation, link.translation_m};
    Rigid<frame::World, frame::Object> world_from_object;
    if (object->world_from_object) world_from_object = *object->world_from_object;
    return world_from_object * object_from_board;
  }
  return std::nullopt;
}

void place_images(manifest::Document& document, const std::string& by) {
  for (manifest::ImageEntry& image : document.images) {
    if (!image.camera_from_board || image.weight.value_or(1) == 0) continue;
    const auto place = world_from_board(document, image.board);
    if (!place) continue;
    if (!image.world_from_camera) image.world_from_camera.emplace();
    static_cast<Rigid<frame::World, frame::Camera>&>(*image.world_from_camera) =
        *place * inverse(*image.camera_from_board);
    manifest::remember_view(document, image, by);
  }
}

}  // namespace gonio::camera
