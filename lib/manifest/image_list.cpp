#include "manifest/image_list.h"

#include <algorithm>

#include "manifest/document.h"
#include "manifest/sections/image.h"

namespace gonio::manifest {
namespace {

std::string pointer_to_image(std::size_t image) {
  return "/images/" + std::to_string(image);
}

}  // namespace

std::optional<std::size_t> index_of_image(const Document& document, const std::string& id) {
  const auto found = std::ranges::find(document.images, id, &ImageEntry::id);
  if (found == document.images.end()) return std::nullopt;
  return static_cast<std::size_t>(found - document.images.begin());
}

const std::string& camera_of_image(const Document& document, std::size_t image) {
  return document.images.at(image).camera;
}

std::filesystem::path picture_path(const Document& document, std::size_t image) {
  return resolve(document, document.images.at(image).file, pointer_to_image(image) + "/file");
}

std::filesystem::path mask_path(const Document& document, std::size_t image) {
  const std::string& mask = document.images.at(image).mask;
  return mask.empty() ? std::filesystem::path() : resolve(document, mask, pointer_to_image(image) + "/mask");
}

std::vector<std::filesystem::path> files_of_image(const Document& document, std::size_t image) {
  std::vector<std::filesystem::path> files;
  if (!document.images.at(image).file.empty()) files.push_back(picture_path(document, image));
  if (const auto mask = mask_path(document, image); !mask.empty()) files.push_back(mask);
  return files;
}

void enter_image(Document& document, const PlannedImage& planned) {
  ImageEntry& image = document.images.emplace_back();
  image.id = planned.id;
  image.camera = planned.camera;
  image.world_from_camera = planned.world_from_camera;
  image.light = planned.light;
  image.noise = planned.noise;
  image.group = planned.group;
}

void keep_images(Document& document, const std::vector<std::string>& ids) {
  std::erase_if(document.images,
                [&](const ImageEntry& image) { return std::ranges::find(ids, image.id) == ids.end(); });
}

}  // namespace gonio::manifest
