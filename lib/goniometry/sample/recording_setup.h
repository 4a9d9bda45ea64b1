// A recording as its manifest states it, checked: which patch is the sample, which the tile, which images show them,
// and everything that a picture's reduction needs of cameras and lights. Error(data) at the place in the manifest.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "goniometry/sample/patch_reading.h"
#include "goniometry/sample/recording.h"
#include "manifest/document.h"
#include "manifest/sections/flat_patch.h"
#include "manifest/sections/image.h"
#include "scene/scene.h"

namespace gonio::goniometry {

struct Shown {  // a patch of the section "goniometer"
  std::string name, place;
  manifest::FlatPatch entry;
  Patch patch;
  std::vector<bool> in;  // per image of the recording
};

struct Recording {
  const manifest::Document* document = nullptr;
  std::vector<std::size_t> images;  // of the document, that show sample or tile
  scene::Scene scene;               // views: those images, in this order; lights; the tile's surface
  std::optional<Shown> sample, tile;
  std::optional<Reflector> reflector;  // of the tile
  std::vector<Rgb> light_sigma;        // relative, of calibrated lights; per light of the scene
  std::string place(std::size_t view) const {
    return manifest::place(*document, "/images/" + std::to_string(images[view]));
  }
  const manifest::ImageEntry& image(std::size_t view) const { return document->images[images[view]]; }
};

Recording set_up(const manifest::Document& document, const ReduceOptions& options);

}  // namespace gonio::goniometry
