// The manifest's side of a comparison: which photograph belongs to which rendering, and where the numbers go.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "metric/comparison.h"

namespace gonio::metric {

struct Entry {
  std::string image;                                  // id
  std::filesystem::path photograph, rendering, mask;  // mask empty: every pixel counts
  manifest::Value response, rendering_response;       // null: EXR, linear
  std::optional<double> saturation{};                 // of the photograph
  std::string photograph_place, rendering_place;      // for messages
  std::optional<manifest::Noise> noise;
  // Where given: what becomes of the photograph as it was read, and of the noise that is stated for it.
  std::function<void(photograph::LinearPicture& photograph, std::optional<manifest::Noise>& noise)> prepare{};
};

// One entry per rendering, in the order of the manifest. Error(data) where there is none, or none of a photograph.
std::vector<Entry> entries(const manifest::Document& document);

// The quick form: a document of one image and its rendering, entered as files.
manifest::Document document_of(const Entry& entry);

Overlay lay_over(const Entry& entry, Channels channels);

// Replaces the image's comparison, or adds one. `files`: what was written beside it, name -> file id.
void enter(manifest::Document& document, const std::string& image, const Measures& measures,
           const std::map<std::string, std::string>& files);

}  // namespace gonio::metric
