// See scan_document.h: photographs of the command line as images of the manifest.
#include <algorithm>
#include <filesystem>
#include <map>

#include "base/error.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/text.h"
#include "camera/picture_names.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "manifest/sections/projection.h"
#include "scan/scan_document.h"

namespace gonio::scan {
namespace {

// Names with their numbers as numbers: 2.png before 10.png.
bool comes_before(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto number = [&digit](const std::string& text, std::size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const std::size_t from = at;
      while (at < text.size() && digit(text[at])) ++at;
      return text.substr(from, at - from);
    };
    const std::string x = number(a, i), y = number(b, j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  return a.size() - i < b.size() - j;
}

}  // namespace

void enter_photographs(const std::vector<std::string>& paths, const std::string& projection,
                       const std::vector<std::string>& cameras, const std::string& response,
                       manifest::Document& document) {
  std::map<std::string, std::vector<std::string>> of;
  for (const std::string& path : paths) {
    const std::string camera = cameras.size() == 1 ? cameras[0] : camera::camera_of_picture(path, cameras);
    if (camera.empty())
      throw Error(Exit::usage, path, "is the picture of none, or of several, of the cameras",
                  "name pictures after their camera, left01.png or left/01.png, or write a manifest with images");
    of[camera].push_back(path);
  }
  const std::size_t frames = document.projections.at(projection).frames.size();
  for (const std::string& camera : cameras) {
    std::vector<std::string>& own = of[camera];
    std::ranges::sort(own, comes_before);
    if (own.size() != frames)
      throw Error(Exit::data, own.empty() ? "PICTURE" : own.back(),
                  format("is the last of %zu pictures by camera %s, and the projection %s has %zu frames", own.size(),
                         camera.c_str(), projection.c_str(), frames),
                  "give every frame once, or write a manifest whose images say what they show");
    parallel_for(0, frames, [&own](std::size_t f) {
      if (!std::filesystem::is_regular_file(own[f]))
        throw Error(Exit::no_input, own[f], "is no file", "give the pictures of the sequence");
      (void)sha256_of_file(own[f]);  // side by side; add_file() asks again
    });
    for (std::size_t f = 0; f < frames; ++f) {
      manifest::ImageEntry image;
      const std::string id = camera + "-" + std::filesystem::path(own[f]).stem().string();
      image.id = id;
      for (int k = 2; manifest::index_of_image(document, image.id); ++k) image.id = id + "-" + std::to_string(k);
      image.file = manifest::add_file(document, own[f], image.id);
      image.camera = camera, image.projection = projection, image.shows = static_cast<std::int64_t>(f);
      if (std::filesystem::path(own[f]).extension() != ".exr") image.response = response;
      document.images.push_back(std::move(image));
    }
  }
}

}  // namespace gonio::scan
