#include "render/entries.h"

#include <algorithm>

#include "base/error.h"

namespace gonio::render {
namespace {

void forget(manifest::Parameters& parameters) {
  for (auto& [name, parameter] : parameters)
    if (parameter.free && parameter.min && parameter.max)
      for (double& v : parameter.value) v = 0.5 * (*parameter.min + *parameter.max);
}

}  // namespace

std::vector<std::size_t> chosen_images(const manifest::Document& document, const std::vector<std::string>& ids) {
  const auto& images = document.images;
  if (images.empty())
    throw Error(Exit::data, manifest::place(document, "/images"), "no image to simulate", "add one, with its camera");
  for (const std::string& id : ids)
    if (std::none_of(images.begin(), images.end(), [&](const auto& image) { return image.id == id; }))
      throw Error(Exit::usage, "--image", "there is no image \"" + id + "\"", "name one of `images`");
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < images.size(); ++i)
    if (ids.empty() || std::find(ids.begin(), ids.end(), images[i].id) != ids.end()) chosen.push_back(i);
  return chosen;
}

void enter_rendering(manifest::Document& document, std::size_t image, const std::filesystem::path& path, int spp,
                     std::uint64_t seed) {
  const std::string& id = document.images[image].id;
  const std::string file = manifest::add_file(document, path, "rendering-" + id);
  auto& all = document.renderings;
  const auto earlier = std::find_if(all.begin(), all.end(), [&](const auto& r) { return r.image == id; });
  manifest::Rendering& entry = earlier != all.end() ? *earlier : all.emplace_back();
  entry = {.image = id, .file = file, .spp = spp, .seed = seed};
}

void enter_recording(manifest::Document& document, std::size_t image, const std::filesystem::path& path) {
  manifest::ImageEntry& entry = document.images[image];
  entry.file = manifest::add_file(document, path, "recording-" + entry.id);
  entry.response = "linear";
}

void forget_free_values(manifest::Document& document) {
  for (auto& [id, surface] : document.surfaces) forget(surface.parameters);
  for (auto& [id, light] : document.lights) forget(light.parameters);
}

}  // namespace gonio::render
