// See image_views.h.
#include "explain/tables/image_views.h"

#include <cstdlib>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"

namespace gonio::explain::tables {
namespace {

std::string known_as(double value, const std::vector<std::string>& known) {
  const std::string text = shortest_text(value);
  for (const std::string& name : known) {
    char* end = nullptr;
    if (!name.empty() && std::strtod(name.c_str(), &end) == value && *end == 0) return name;
  }
  return text;
}

std::vector<double> six_of(const manifest::PoseSigma& sigma) {
  std::vector<double> six;
  for (const std::vector<double>* part : {&sigma.rotation_rad, &sigma.translation_m})
    for (std::size_t k = 0; k < 3; ++k)
      six.push_back(part->empty() ? 0 : part->size() == 1 ? part->front() : part->at(k));
  return six;
}

}  // namespace

Names names_in(const Table& table, const std::string& column, const std::vector<std::string>& known) {
  const std::vector<double>& values = table.needed(column, "");
  const std::vector<std::string>& labels = table.labels[table.place_of(column)];
  Names names;
  std::map<double, std::size_t> seen;
  for (const double value : values) {
    const auto [entry, fresh] = seen.try_emplace(value, names.all.size());
    if (fresh) names.all.push_back(labels.empty() ? known_as(value, known) : labels[static_cast<std::size_t>(value)]);
    names.of_row.push_back(entry->second);
  }
  return names;
}

ImageView image_view(const manifest::Document& document, const std::string& id, const Table& table) {
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& image = document.images[i];
    if (image.id != id) continue;
    const std::string at = "/images/" + std::to_string(i);
    const auto camera = document.cameras.find(image.camera);
    if (camera == document.cameras.end())
      throw Error(Exit::data, manifest::place(document, at + "/camera"),
                  "is not described, and " + table.place + " has sightings in this image", "describe it in cameras");
    ImageView view{
        id,           image.group,
        image.camera, camera::CameraModel(camera->second, manifest::place(document, "/cameras/" + image.camera)),
        {},           {}};
    if (image.world_from_camera) {
      view.world_from_camera = *image.world_from_camera;
      if (image.world_from_camera->sigma) view.sigma = six_of(*image.world_from_camera->sigma);
    }
    return view;
  }
  throw Error(Exit::data, table.place, "has sightings in image \"" + id + "\", which the manifest does not have",
              "enter it in images, with its camera and world_from_camera");
}

}  // namespace gonio::explain::tables
