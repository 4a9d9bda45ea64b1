// Virtual goniometer recordings: a document is rendered, image by image, as its virtual sensor would record it.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "geom/angle.h"
#include "goniometry/sample/recording.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "render/entries.h"
#include "render/looking_at.h"
#include "render/path_tracer.h"
#include "render/specimen_camera.h"
#include "render/virtual_sensor.h"
#include "scene/scene.h"

namespace gonio::tests {

inline Vec3 direction(double theta_rad, double phi_rad) {
  return {std::sin(theta_rad) * std::cos(phi_rad), std::sin(theta_rad) * std::sin(phi_rad), std::cos(theta_rad)};
}

struct Lighted {
  std::string light;
  double theta_rad, phi_rad;  // of the camera
};

inline void add_image(manifest::Document& document, const std::string& id, const Lighted& view, double distance_m,
                      Vec3 target_m = {}) {
  const Vec3 at_m = target_m + direction(view.theta_rad, view.phi_rad) * distance_m;
  render::add_view(document,
                   {.id = id, .world_from_camera = {render::looking_at(at_m, target_m)}, .light = {view.light}});
}

using Rendered = std::vector<io::Image>;  // radiance, per image of the document
inline Rendered render_all(const manifest::Document& document, int spp) {
  const scene::Scene scene = scene::build_scene(document);
  const render::RayCaster caster(scene.instances);
  render::Options options{.spp = spp, .seed = 7, .geometry = false};
  Rendered result;
  for (std::size_t i = 0; i < scene.views.size(); ++i) result.push_back(render::render(scene, i, caster, options));
  return result;
}

// Pictures with the sensor's noise in `folder`; the images name them. `spoil` may touch a picture before it is written.
using Spoil = std::function<void(std::size_t, io::Image&)>;
inline void record(manifest::Document& document, const Rendered& rendered, const std::filesystem::path& folder,
                   std::uint64_t seed, const Spoil& spoil = {}) {
  document.folder = folder;
  document.name = "recording.json";
  const auto ids = names_in(document, "images");
  for (std::size_t i = 0; i < rendered.size(); ++i) {
    io::Image picture = render::recorded(rendered[i], render::sensor_of(document, i), ids[i], seed);
    if (spoil) spoil(i, picture);
    const auto path = folder / (ids[i] + ".exr");
    io::write_picture(path, picture);
    render::enter_recording(document, i, path);
  }
}

}  // namespace gonio::tests
