// Scenes for and from other renderers. A format is one file in formats/, with that program's conventions at its head;
// the build gathers them. A writer never leaves anything out in silence: what the other program cannot express stands
// in `losses`, one entry each, with what it will show instead.
//
// Here: world frame and metres, W/sr and W/(m^2 sr); pixel centres at integers; camera axes x right, y down, z forward.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "manifest/document.h"
#include "scene/scene.h"

namespace gonio::scene {

struct Loss {
  std::string pointer;  // JSON pointer into the manifest (export), or where in the foreign file (import)
  std::string what, instead;
  bool operator==(const Loss&) const = default;
};
struct ExchangedFile {
  std::string name, content;  // name: relative, folders with /
};
struct Exported {
  std::vector<ExchangedFile> files;
  std::vector<Loss> losses;
};
struct Imported {
  manifest::Document document;       // `files` name what stands in `files` below
  std::vector<ExchangedFile> files;  // meshes and pictures
  std::vector<Loss> losses;
};

class Exchange {
 public:
  virtual ~Exchange() = default;
  virtual std::string_view name() const = 0;  // as typed: "blender"
  virtual std::string_view sentence() const = 0;
  virtual Exported write(const Scene& scene) const = 0;
  virtual std::vector<std::string_view> extensions() const { return {}; }  // of files that read() takes: ".gltf"
  virtual Imported read(const std::filesystem::path& path) const;          // Error(usage) where it does not
};

std::span<const Exchange* const> all_exchanges();                     // generated
const Exchange* find_exchange(std::string_view name);                 // null pointer where there is none
const Exchange& importer_of(const std::filesystem::path& path);       // Error(usage) where none reads such files
Exported export_scene(const Scene& scene, const Exchange& exchange);  // write(), and the losses common to all

}  // namespace gonio::scene
