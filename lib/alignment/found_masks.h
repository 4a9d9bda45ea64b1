// Masks of an object and of its shadows that the photographs themselves give (segmentation.h), entered as outlines.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "manifest/sections/forward.h"

namespace gonio::alignment {

struct MaskWish {
  enum class By { given, lamps, background, alone, strokes } by = By::given;
  std::string object{};                              // whose masks; empty: the only one with a mesh from a file
  std::map<std::string, std::string> backgrounds{};  // image to the image of the same place without the object
  std::map<std::string, std::filesystem::path>
      strokes{};  // image to a picture: red object, blue its shadow, green ground
};

// Adds outlines of kind object and shadow for every image that has a picture and a camera (and is no background), and
// their masks as files IMAGE-OBJECT-KIND-mask.exr, channel Y, with what nobody can tell in the channel `unknown`.
// Outlines that the document has of an image are kept, and nothing is added there. Error(data | usage) where it cannot
// be done.
void find_masks(manifest::Document& document, const MaskWish& wish,
                const std::function<std::filesystem::path(const std::string& name)>& output_path,
                const std::function<void(const std::filesystem::path&)>& note_input);

}  // namespace gonio::alignment
