// See mosaic_input.h and polarization_problem.h.
#include "explain/polarization/mosaic_input.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "camera/intrinsics.h"
#include "camera/mosaic.h"
#include "explain/polarization/polarization_problem.h"
#include "explain/switched_on.h"
#include "explain/traced/takes.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "render/link.h"
#include "render/mechanisms/optics_veiling_glare.h"
#include "scene/mechanisms.h"

namespace gonio::mechanism {
const Mechanism& surface_coating();
}

namespace gonio::explain {
namespace polarization {
namespace {

constexpr const char* domain_name = "polarization";

bool is_mosaic(const manifest::Document& document, const manifest::ImageEntry& image) {
  return !image.file.empty() && !image.camera.empty() && image.weight.value_or(1) != 0 &&
         camera::mosaic_of(document, image.camera) == camera::polarizers;
}

const render::Link* link_of(const mechanism::Mechanism& mechanism) {
  for (const render::Link* link : render::all_links())
    if (&link->mechanism() == &mechanism) return link;
  return nullptr;
}

}  // namespace

std::vector<std::string> mosaic_cameras(const manifest::Document& document) {
  std::set<std::string> cameras;
  for (const manifest::ImageEntry& image : document.images)
    if (is_mosaic(document, image)) cameras.insert(image.camera);
  return {cameras.begin(), cameras.end()};
}

manifest::Document images_of(manifest::Document document, const std::string& camera) {
  for (manifest::ImageEntry& image : document.images)
    if (image.camera != camera || image.file.empty()) image.weight = 0;
  return document;
}

void write_gain(manifest::Document& document, std::size_t entry, double factor) {
  manifest::ImageEntry& image = document.images.at(entry);
  manifest::Parameter gain = image.gain ? *image.gain : manifest::Parameter(1.0);
  gain.value.at(0) *= factor;
  image.gain = gain;
}

photograph::PolarizerArray array_in_use(const manifest::Document& document, const std::string& camera) {
  photograph::PolarizerArray array;
  for (const auto& [id, use] : document.mechanisms) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    const render::Link* link = m == nullptr ? nullptr : link_of(*m);
    if (link == nullptr || link->polarizers == nullptr) continue;
    if (const auto amounts = scene::camera_amounts(*m, use, camera, manifest::place(document, "/mechanisms/" + id)))
      link->polarizers(*amounts, array);
  }
  return array;
}

double veil_in_use(const manifest::Document& document, const std::string& camera) {
  const mechanism::Mechanism& m = mechanism::optics_veiling_glare();
  const auto use = document.mechanisms.find(m.id);
  if (use == document.mechanisms.end()) return 0;
  const auto amounts = scene::camera_amounts(m, use->second, camera, manifest::place(document, "/mechanisms/" + m.id));
  return amounts ? amounts->at(0) : 0;
}

std::vector<Film> films_in_use(const manifest::Document& document, const Setup& setup) {
  const mechanism::Mechanism& m = mechanism::surface_coating();
  std::vector<Film> films(setup.mirrors.size());
  for (std::size_t k = 0; k < films.size(); ++k) {
    const auto on = switched_on_for(document, domain_name, setup.mirrors[k].name);
    const auto use = on.find(m.id);
    if (use == on.end()) continue;
    const auto number = [&](const mechanism::Parameter& p) {
      const auto given = use->second.find(p.name);
      return given != use->second.end() ? given->second.scalar() : p.neutral;
    };
    films[k] = {number(m.parameters[0]), number(m.parameters[1])};
  }
  return films;
}

bool is_in_use(const manifest::Document& document, const mechanism::Mechanism& mechanism, const std::string& camera) {
  const auto use = document.mechanisms.find(mechanism.id);
  if (use == document.mechanisms.end()) return false;
  return mechanism.target != mechanism::Target::camera ||
         scene::camera_amounts(mechanism, use->second, camera, manifest::place(document, "/mechanisms/" + mechanism.id))
             .has_value();
}

void refuse_few(const manifest::Document& document, const std::string& camera, std::size_t rows) {
  throw Error(
      Exit::data, manifest::place(document, "/cameras/" + camera),
      format("%zu samples of its pictures can be held against the simulation, and 400 are needed", rows),
      "the scene must be lit as the manifest says, objects must stand where it says, and masks must leave them");
}

}  // namespace polarization

using namespace polarization;

bool has_mosaics(const manifest::Document& document) {
  return !document.objects.empty() && !mosaic_cameras(document).empty();
}

void check_mosaics(const manifest::Document& document) {
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    if (!is_mosaic(document, document.images[i])) continue;
    const io::Image picture = io::read_picture(manifest::picture_path(document, i));
    const bool stokes = picture.channel("s1.Y") >= 0 || picture.channel("s1.R") >= 0;
    if (picture.channel("Y") >= 0 && !stokes) continue;
    throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(i) + "/file"),
                stokes ? "has Stokes components that were interpolated between polarizers"
                       : "has colours, and a camera behind polarizers has one reading a pixel",
                "name the mosaic as the camera wrote it, one channel Y");
  }
  for (const std::string& id : traced::behind_the_lens(document)) {
    const render::Link* link = link_of(*mechanism::find_mechanism(id));
    if (link->polarizers == nullptr && id != mechanism::optics_veiling_glare().id)
      throw Error(Exit::data, manifest::place(document, "/mechanisms/" + id),
                  "acts on whole pictures, and mosaic photographs are asked sample by sample",
                  "switch it off, or take it off the pictures");
  }
}

std::vector<std::filesystem::path> mosaic_files(const manifest::Document& document) {
  std::vector<std::filesystem::path> files;
  for (std::size_t i = 0; i < document.images.size(); ++i)
    if (is_mosaic(document, document.images[i]))
      for (std::filesystem::path& file : manifest::files_of_image(document, i)) files.push_back(std::move(file));
  return files;
}

}  // namespace gonio::explain
