// The list of images, for sources that plan recordings, choose among them or hand their files on, and do not ask how
// each was made. Those that do include manifest/sections/image.h.
#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "manifest/noise.h"
#include "manifest/pose.h"
#include "manifest/sections/forward.h"

namespace gonio::manifest {

// Place in document.images of the one with this id; nothing where there is none.
std::optional<std::size_t> index_of_image(const Document& document, const std::string& id);
// The name of its camera, as stated: may be empty.
const std::string& camera_of_image(const Document& document, std::size_t image);

// Where its files lie now (resolve). Error(data) where it names no picture; an empty path where it names no mask.
std::filesystem::path picture_path(const Document& document, std::size_t image);
std::filesystem::path mask_path(const Document& document, std::size_t image);
// The picture and the mask, those of them that it names.
std::vector<std::filesystem::path> files_of_image(const Document& document, std::size_t image);

// An image that is still to be taken: what a camera needs to know, be it a virtual one.
struct PlannedImage {
  std::string id, camera{};
  Pose<frame::World, frame::Camera> world_from_camera{};
  std::vector<std::string> light{};  // that are on; empty: every light of the scene
  std::optional<Noise> noise{};
  std::string group{};
};
void enter_image(Document& document, const PlannedImage& planned);

// Leaves in the list the images with these ids, in the order that they have there.
void keep_images(Document& document, const std::vector<std::string>& ids);

}  // namespace gonio::manifest
