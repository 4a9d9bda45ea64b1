// Takes pieces out of their own manifests into the scene's.
#include <algorithm>
#include <map>

#include "base/error.h"
#include "manifest/codec.h"
#include "manifest/section_tables.h"
#include "manifest/sections/file.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/volume.h"
#include "reassembly/piece_document.h"

namespace gonio::reassembly {
namespace {

using manifest::Document;

// Files are entered anew: other folder, other ids; one file that several sections name is one entry.
class FileMover {
 public:
  FileMover(Document& into, const Document& from, std::string as) : into_(into), from_(from), as_(std::move(as)) {}
  std::string moved(const std::string& id, const std::string& user) {
    if (id.empty()) return id;
    const auto known = moved_.find(id);
    if (known != moved_.end()) return known->second;
    const auto path = manifest::resolve(from_, id, user);
    return moved_[id] = manifest::add_file(into_, path, as_ + "-" + id);
  }

 private:
  Document& into_;
  const Document& from_;
  std::string as_;
  std::map<std::string, std::string> moved_;
};

const manifest::Object& chosen_object(const Document& other, const std::string& wanted) {
  const auto has_markers = [&](const manifest::Object& o) {
    return std::ranges::any_of(other.markers, [&](const manifest::Marker& m) { return m.object == o.id; });
  };
  const manifest::Object* chosen = nullptr;
  std::string names;
  for (const manifest::Object& o : other.objects) {
    if (!has_markers(o)) continue;
    names += (names.empty() ? "" : ", ") + o.id;
    if (wanted.empty() ? chosen == nullptr : o.id == wanted) chosen = &o;
  }
  if (names.empty())
    throw Error(Exit::data, manifest::place(other, "/markers"), "no object has markers",
                "find them: ct-mesh-clean --markers RADIUS");
  if (chosen == nullptr || (wanted.empty() && names.find(',') != std::string::npos))
    throw Error(Exit::data, manifest::place(other, "/objects"),
                "has " + names + (wanted.empty() ? "" : ", not " + wanted), "say which: --piece NAME=FILE#OBJECT");
  return *chosen;
}

template <class T>
void enter_surface(Document& into, const Document& other, const std::string& name, const T& surface) {
  const auto [there, fresh] = into.surfaces.try_emplace(name, surface);
  if (!fresh && manifest::Codec<T>::write(there->second) != manifest::Codec<T>::write(surface))
    throw Error(Exit::data, manifest::place(other, "/surfaces/" + name),
                "is another surface than the scene's of that name", "rename one of them");
}

}  // namespace

std::string take_in(Document& into, const Document& other, const std::string& object, const std::string& as) {
  const manifest::Object& source = chosen_object(other, object);
  const std::string name = as.empty() ? source.id : as;
  if (std::ranges::any_of(into.objects, [&](const manifest::Object& o) { return o.id == name; }) ||
      into.meshes.contains(name) || into.volumes.contains(name))
    throw Error(Exit::data, manifest::place(other, "/objects"), "\"" + name + "\" is in the scene already",
                "give it another name: --piece NAME=FILE");
  FileMover files(into, other, name);
  manifest::Mesh mesh = other.meshes.at(source.mesh);
  mesh.file = files.moved(mesh.file, "/meshes/" + source.mesh + "/file");
  for (std::string& shape : mesh.shapes) shape = files.moved(shape, "/meshes/" + source.mesh + "/shapes");
  into.meshes[name] = mesh;
  manifest::Surface surface = other.surfaces.at(source.surface);
  if (surface.file.empty() && surface.textures.empty() && surface.spectra.empty() && surface.base.empty())
    enter_surface(into, other, source.surface, surface);
  else
    throw Error(Exit::data, manifest::place(other, "/surfaces/" + source.surface), "names files or another surface",
                "put it into the scene's manifest, under the same name, and a plain one here");
  for (const auto& [id, volume] : other.volumes) {
    if (volume.mesh != source.mesh) continue;
    manifest::Volume own = volume;
    const std::string at = "/volumes/" + id;
    own.mesh = name;
    own.reference.clear();
    own.file = files.moved(own.file, at + "/file");
    for (std::string& slice : own.slices) slice = files.moved(slice, at + "/slices");
    for (manifest::VolumeStep& step : own.steps) step.picture = files.moved(step.picture, at + "/steps");
    if (!own.markers_mesh.empty()) {
      manifest::Mesh markers = other.meshes.at(own.markers_mesh);
      markers.file = files.moved(markers.file, "/meshes/" + own.markers_mesh + "/file");
      into.meshes[own.markers_mesh = name + "-markers"] = markers;
    }
    into.volumes[name] = std::move(own);
    break;
  }
  int number = 0;
  for (manifest::Marker marker : other.markers) {
    if (marker.object != source.id) continue;
    marker.id = name + "-" + std::to_string(++number);
    marker.object = name;
    marker.volume = into.volumes.contains(name) ? name : "";
    marker.seen_in.clear();
    marker.pixel.clear();
    into.markers.push_back(std::move(marker));
  }
  manifest::Object entered = source;
  entered.id = entered.mesh = name;
  entered.world_from_object.reset();
  into.objects.push_back(std::move(entered));
  return name;
}

}  // namespace gonio::reassembly
