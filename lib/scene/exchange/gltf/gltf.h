// Parts of glTF that writing and reading share (scene/exchange/formats/gltf.cpp says which conventions they follow).
#pragma once
#include <map>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "scene/exchange/exchange.h"
#include "scene/exchange/gltf/source.h"
#include "scene/exchange/look.h"

namespace gonio::scene::gltf2 {

// Lumens per watt at 555 nm: photometric units of glTF count one watt as so many lumens.
inline constexpr double lumens_per_watt = 683;

// y up, as glTF has it, from our z up: a quarter turn about x.
inline Quaternion gltf_from_world() {
  const double half = std::sqrt(0.5);
  return {half, -half, 0, 0};
}

// A list of glTF's whose entries are written once each.
class List {
 public:
  int add(manifest::Value entry);  // its place; that of an equal one where there is one
  const manifest::Value& value() const { return entries_; }
  bool empty() const { return entries_.as_array().empty(); }

 private:
  manifest::Value entries_ = manifest::Value::array();
};

// Materials, textures and pictures of a file that is being written.
class MaterialWriter {
 public:
  explicit MaterialWriter(Exported& out) : out_(out) {}
  // `size_m`: the smallest extent of what bears the surface. Fills the look's losses.
  int write(const Scene& scene, const Surface& surface, double size_m);
  void finish(manifest::Value& root) const;  // materials, textures, images, extensionsUsed

 private:
  void lose(const std::string& pointer, std::string what, std::string instead);
  manifest::Value& extension(manifest::Value& material, const char* name);
  manifest::Value texture(const Surface& surface, const Texture& texture);
  void write_roughness(const Look& look, const Surface& surface, manifest::Value& material);
  void write_glass(const Look& look, const std::string& pointer, double size_m, manifest::Value& material);
  void write_kind(const Look& look, const std::string& pointer, double size_m, manifest::Value& material);
  void write_losses(const Look& look, const std::string& pointer);

  Exported& out_;
  manifest::Value materials_ = manifest::Value::array();
  List textures_, images_;
  std::vector<std::string> extensions_;
};

// Materials of a file that is being read, as surfaces of `imported`.
class MaterialReader {
 public:
  MaterialReader(const Source& source, Imported& imported) : source_(source), imported_(imported) {}
  std::string surface_of(const Item& index);  // its name; glTF's own material where there is no index

 private:
  std::string read(const Item& material);
  void lose(const Item& at, std::string what, std::string instead);
  void read_colour(const Item& factor, const Item& texture, const char* parameter, manifest::Surface& surface);
  void read_roughness(const Item& metallic_roughness, manifest::Surface& surface);
  void read_matte(const Item& material, manifest::Surface& surface);
  void read_glass(const Item& material, manifest::Surface& surface);
  void read_losses(const Item& material);
  std::string coat(const Item& material, const std::string& name);
  io::Image picture_of(const Item& texture);
  std::string free_name(const std::string& wanted) const;

  const Source& source_;
  Imported& imported_;
  std::map<std::string, std::string> known_;  // pointer of a material -> name of its surface
};

Exported write_scene(const Scene& scene);
Imported read_scene(const std::filesystem::path& path);

// An empty name becomes `otherwise`; one that is taken gets a number.
template <class Map>
std::string unused_name(const Map& taken, const std::string& wanted, const std::string& otherwise) {
  const std::string base = wanted.empty() ? otherwise : wanted;
  std::string name = base;
  for (int i = 2; taken.contains(name); ++i) name = base + "-" + std::to_string(i);
  return name;
}

}  // namespace gonio::scene::gltf2
