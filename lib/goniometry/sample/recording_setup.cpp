// Checks of a recording before any picture is read (goniometry/sample/recording_setup.h).
//
// Cameras, lights and the tile's surface become those of a scene (scene/scene.h), so that mechanisms of lenses and
// lamps act on a recording as they do on a rendering.
#include "goniometry/sample/recording_setup.h"

#include <algorithm>

#include "base/error.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "scene/mechanisms/optics_vignetting.h"
#include "scene/mechanisms/reference_tile.h"

namespace gonio::goniometry {
namespace {

// It states what it reflects, or a sample refers to it.
bool is_tile(const manifest::Document& document, const std::string& name) {
  const manifest::FlatPatch& entry = document.goniometer.at(name);
  return !entry.reflectance.empty() || !entry.surface.empty() ||
         std::ranges::any_of(document.goniometer, [&](const auto& other) { return other.second.tile == name; });
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string sample_name(const manifest::Document& document, const std::string& asked) {
  const std::string section = manifest::place(document, "/goniometer");
  if (document.goniometer.empty())
    throw Error(Exit::data, section, "is missing: nothing says where the sample lies",
                R"(add "goniometer": {"NAME": {"world_from_sample": {...}, "radius_m": 0.003}})");
  std::vector<std::string> samples;
  for (const auto& [name, entry] : document.goniometer)
    if (!is_tile(document, name)) samples.push_back(name);
  if (!asked.empty()) {
    if (!document.goniometer.contains(asked))
      throw Error(Exit::data, section, "has no \"" + asked + "\"", "there is " + listed(samples));
    return asked;
  }
  if (samples.empty())
    throw Error(Exit::data, section, "holds white tiles alone: each entry states what it reflects",
                "leave \"reflectance\" and \"surface\" out of the sample's entry");
  if (samples.size() > 1)
    throw Error(Exit::data, section, "holds several samples: " + listed(samples), "name the one that is meant");
  return samples.front();
}

Shown shown(const manifest::Document& document, const std::string& name) {
  const std::string place = manifest::place(document, "/goniometer/" + name);
  const manifest::FlatPatch& entry = document.goniometer.at(name);
  if (!entry.world_from_sample)
    throw Error(Exit::data, place + "/world_from_sample", "is missing: where the patch lies is not known",
                "give its pose: z along its normal, x where azimuths count from");
  return {name, place, entry, Patch(entry, place), {}};
}

bool shows(const Shown& patch, const manifest::ImageEntry& image) {
  const auto& ids = patch.entry.images;
  return ids.empty() ? !image.file.empty() : std::ranges::find(ids, image.id) != ids.end();
}

void check_image(const manifest::Document& document, std::size_t index, bool per_exposure) {
  const manifest::ImageEntry& image = document.images[index];
  const std::string place = manifest::place(document, "/images/" + std::to_string(index));
  if (image.file.empty()) throw Error(Exit::data, place, "has no recording", "name its file under \"file\"");
  if (image.camera.empty() || !has_entry(document, "cameras", image.camera))
    throw Error(Exit::data, place + "/camera", "is missing", "name one of `cameras`");
  if (!image.world_from_camera)
    throw Error(Exit::data, place + "/world_from_camera", "is missing: from where the sample was seen is not known",
                "give the camera's pose (handeye, or the goniometer's angles)");
  if (per_exposure && !image.exposure_s)
    throw Error(Exit::data, place + "/exposure_s", "is missing, and the values are stated to grow with it",
                "give the exposure time, or state \"values\": \"radiance\"");
}

// What the sample, the tile and the images need of the manifest, and nothing else.
manifest::Document part_for_scene(const Recording& recording) {
  manifest::Document part = *recording.document;
  part.images.clear();
  for (const std::size_t index : recording.images) part.images.push_back(recording.document->images[index]);
  part.objects.clear();
  part.surfaces.clear();
  std::string surface = recording.tile ? recording.tile->entry.surface : "";
  for (std::string name = surface; !name.empty() && !part.surfaces.contains(name); name = part.surfaces[name].base)
    part.surfaces[name] = recording.document->surfaces.at(name);
  if (surface.empty()) {
    surface = "white";
    part.surfaces[surface].parameters["albedo"] = manifest::Parameter(1.0);
  }
  part.meshes = {{"patch", {}}};
  const double size_m = 2 * recording.sample->patch.extent_m();
  part.meshes["patch"].plane_size_m = {size_m, size_m};
  manifest::Object object{.id = "patch", .mesh = "patch", .surface = surface, .world_from_object = {}};
  object.world_from_object = recording.sample->entry.world_from_sample;
  part.objects.push_back(object);
  std::erase_if(part.mechanisms, [](const auto& use) {
    return !use.first.starts_with("light.") && !use.first.starts_with("lens.") &&
           use.first != mechanism::optics_vignetting().id;
  });
  return part;
}

double mechanism_amount(const manifest::Document& document, const std::string& id, const char* parameter) {
  const auto use = document.mechanisms.find(id);
  if (use == document.mechanisms.end()) return 0;
  const auto found = use->second.parameters.find(parameter);
  return found == use->second.parameters.end() || !found->second.given() ? 0 : found->second.scalar();
}

Reflector reflector_of(const Recording& recording) {
  const Shown& tile = *recording.tile;
  const bool stated = !tile.entry.reflectance.empty();
  if (stated && !tile.entry.surface.empty())
    throw Error(Exit::data, tile.place, "has both \"reflectance\" and \"surface\"", "keep one of the two");
  if (!stated && tile.entry.surface.empty())
    throw Error(Exit::data, tile.place, "is named as the white tile, and nothing says what it reflects",
                "give \"reflectance\", or \"surface\" for one that is not Lambertian");
  Reflector result;
  const auto& surfaces = recording.scene.appearance.surfaces;
  const auto found = std::ranges::find_if(
      surfaces, [&](const scene::Surface& s) { return s.id == (stated ? "white" : tile.entry.surface); });
  if (found->varies())
    throw Error(Exit::data, tile.place + "/surface", "\"" + found->id + "\" differs from place to place",
                "a tile's surface has the same parameters everywhere");
  result.outer = {found->model, found->values};
  if (found->base) result.base = {surfaces[*found->base].model, surfaces[*found->base].values};
  if (stated) {
    const auto& r = tile.entry.reflectance;
    if (r.size() != 1 && r.size() != 3)
      throw Error(Exit::data, tile.place + "/reflectance", "has " + std::to_string(r.size()) + " numbers",
                  "give one for all bands, or three");
    result.scale = r.size() == 3 ? Rgb{r[0], r[1], r[2]} : Rgb{r[0], r[0], r[0]};
    if (!(std::ranges::min(r) > 0))
      throw Error(Exit::data, tile.place + "/reflectance", "is 0: such a tile shows no light", "give what it reflects");
    result.falls_in = mechanism_amount(*recording.document, mechanism::reference_tile().id, "incidence");
    result.falls_out = mechanism_amount(*recording.document, mechanism::reference_tile().id, "exitance");
  }
  return result;
}

// Relative standard deviation of a light that the manifest states: given, not free. Error(data) for others.
Rgb calibrated(const manifest::Document& document, const scene::Light& light) {
  const manifest::Light& entry = document.lights.at(light.id);
  Rgb sigma;
  for (const manifest::ParameterInfo& info : light.model->info().parameters) {
    if (!info.rgb) continue;
    const auto given = entry.parameters.find(info.name);
    const std::string place = manifest::place(document, "/lights/" + light.id + "/" + info.name);
    if (given == entry.parameters.end() || !given->second.given() || given->second.free)
      throw Error(Exit::data, place,
                  std::string(given == entry.parameters.end() ? "is not stated" : "is free") +
                      ", and no white tile shows how much light there is",
                  "name a white tile (\"tile\" of the sample), or state the light's calibrated value");
    const auto stated = entry.sigma.find(info.name);
    if (stated == entry.sigma.end()) continue;
    const auto& s = stated->second;
    const Rgb absolute = s.size() == 3 ? Rgb{s[0], s[1], s[2]} : Rgb{s.at(0), s.at(0), s.at(0)},
              v = given->second.rgb();
    sigma = {absolute.x / v.x, absolute.y / v.y, absolute.z / v.z};
  }
  return sigma;
}

void check_lights(Recording& recording) {
  const auto& lights = recording.scene.appearance.lights;
  if (lights.empty())
    throw Error(Exit::data, manifest::place(*recording.document, "/lights"),
                "is empty: from where the sample was lit is "
                "not known",
                "give the light of each image");
  if (recording.scene.appearance.ambient)
    throw Error(Exit::data, manifest::place(*recording.document, "/mechanisms/light.ambient"),
                "lights the sample from everywhere: its reflectance has no direction then",
                "take it out of the images");
  recording.light_sigma.resize(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const bool used = std::ranges::any_of(
        recording.scene.views, [i](const scene::View& view) { return view.lights == std::vector<std::size_t>{i}; });
    if (!used || !recording.document->lights.contains(lights[i].id)) continue;
    if (lights[i].emitter->infinite())
      throw Error(Exit::data, manifest::place(*recording.document, "/lights/" + lights[i].id),
                  "surrounds the scene: light from one direction is needed", "give a point, directional or area light");
    if (!recording.tile) recording.light_sigma[i] = calibrated(*recording.document, lights[i]);
  }
}

}  // namespace

Recording set_up(const manifest::Document& document, const ReduceOptions& options) {
  Recording recording;
  recording.document = &document;
  recording.sample = shown(document, sample_name(document, options.sample));
  if (const std::string& tile = recording.sample->entry.tile; !tile.empty()) {
    if (tile == recording.sample->name)
      throw Error(Exit::data, recording.sample->place + "/tile", "is the sample itself", "name the white tile's entry");
    recording.tile = shown(document, tile);
  }
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& image = document.images[i];
    const bool sample = shows(*recording.sample, image), tile = recording.tile && shows(*recording.tile, image);
    if (!sample && !tile) continue;
    check_image(document, i,
                (sample && recording.sample->entry.values == "exposure") ||
                    (tile && recording.tile->entry.values == "exposure"));
    recording.images.push_back(i);
    recording.sample->in.push_back(sample);
    if (recording.tile) recording.tile->in.push_back(tile);
  }
  if (std::ranges::count(recording.sample->in, true) == 0)
    throw Error(Exit::data, recording.sample->place, "is shown by no image that has a recording",
                "name recordings under \"file\" of the images");
  scene::Reading reading;
  reading.on_warning = [](const std::string&) {};
  recording.scene = scene::build_scene(part_for_scene(recording), reading);
  check_lights(recording);
  if (recording.tile) recording.reflector = reflector_of(recording);
  return recording;
}

}  // namespace gonio::goniometry
