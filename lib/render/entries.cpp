#include "render/entries.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/rendering.h"
#include "manifest/sections/surface.h"

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
    if (!manifest::index_of_image(document, id))
      throw Error(Exit::usage, "--image", "there is no image \"" + id + "\"", "name one of `images`");
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < images.size(); ++i)
    if (ids.empty() || std::find(ids.begin(), ids.end(), images[i].id) != ids.end()) chosen.push_back(i);
  return chosen;
}

void check_recordable(const manifest::Document& document, std::size_t image) {
  if (document.images[image].noise) return;
  throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(image)),
              "states no noise to record with", "add \"noise\": {\"gain\", \"read\"}");
}

void enter_rendering(manifest::Document& document, std::size_t image, const std::filesystem::path& path,
                     const Facts& facts, const std::vector<double>& wavelengths_m,
                     const std::map<std::string, std::filesystem::path>& beside) {
  const std::string& id = document.images[image].id;
  const std::string file = manifest::add_file(document, path, "rendering-" + id);
  auto& all = document.renderings;
  const auto earlier = std::find_if(all.begin(), all.end(), [&](const auto& r) { return r.image == id; });
  manifest::Rendering& entry = earlier != all.end() ? *earlier : all.emplace_back();
  entry = {};
  entry.image = id;
  entry.file = file;
  entry.spp = static_cast<int>(facts.samples());
  entry.seed = facts.seed;
  if (std::isfinite(facts.relative_error)) entry.relative_error = facts.relative_error;
  entry.wavelengths_m = wavelengths_m;
  if (beside.contains("sums"))
    entry.samples = {static_cast<int>(facts.first_sample), static_cast<int>(facts.end_sample)};
  for (const auto& [kind, file_beside] : beside)
    entry.files[kind] = manifest::add_file(document, file_beside, kind + "-" + id);
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
