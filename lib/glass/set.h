// A set of pictures of glass before a screen, as training data: which cells it has, and what each of them is.
//
// Cell: one view of one object, rendered twice, with the light of the screen alone ("bare") and with that of the room
// as well ("lit"). It is drawn from (seed, object, view) and nothing else, so that cells can be made anywhere, in any
// order: the bytes are the same. A cell's name is its content's: 16 hexadecimal digits of the SHA-256 of its scene
// (which states the hashes of its files) and of how it is rendered.
//
// Objects are split into training, validation and test, never the views of one; each form is in each share as often as
// any other; bodies from one file stay together.
//
// World: z up, the table z = 0, the object's turntable at the origin, the screen behind it across +y, cameras on an arc
// about it on the side of -y.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "glass/body.h"
#include "manifest/document.h"

namespace gonio::glass {

struct SetWish {
  std::uint64_t seed = 1;
  std::size_t objects = 0, views = 1;
  std::vector<std::string> forms{};                   // none: all; each as often
  std::vector<std::filesystem::path> meshes{};        // instead of forms, in the order of their names
  std::vector<std::filesystem::path> surroundings{};  // lat-long pictures instead of drawn rooms
  int width_px = 128, height_px = 128;
  double relative_error = 0.1;  // of a picture
  int most_spp = 512;
};

enum class Share { training, validation, test };
const char* name_of(Share share);  // "training"

struct Cell {
  std::size_t number = 0, object = 0, view = 0;
  Share share = Share::training;
  std::string name;                          // by content
  manifest::Document scene;                  // images "bare" and "lit"; its files lie below the set's folder
  std::map<std::string, std::string> facts;  // for the statistics: "form", "glass", "genus", ...
};

class GlassSet {
 public:
  // Files that cells share, meshes and pictures, are written below `folder` as cells are asked for; whoever writes
  // them, they are the same. Error(usage | data) for a wish without objects, unknown forms, and files that are unfit.
  GlassSet(SetWish wish, std::filesystem::path folder);
  std::size_t cells() const { return wish_.objects * wish_.views; }
  Cell cell(std::size_t number) const;
  Share share_of(std::size_t object) const { return shares_.at(object); }
  const SetWish& wish() const { return wish_; }
  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path folder_of(const Cell& cell) const { return folder_ / "cells" / cell.name; }

 private:
  struct Object;
  const Object& object(std::size_t number) const;  // the last one is kept

  SetWish wish_;
  std::filesystem::path folder_;
  std::vector<Share> shares_;  // of objects
  mutable std::shared_ptr<const Object> last_;
};

}  // namespace gonio::glass
