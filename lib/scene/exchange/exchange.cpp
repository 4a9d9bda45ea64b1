// What all formats share: finding them, and what none of them can express.
#include "scene/exchange/exchange.h"

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "scene/exchange/lens.h"

namespace gonio::scene {
namespace {

void cameras_lose(const Scene& scene, std::vector<Loss>& losses) {
  std::vector<std::string> seen;
  for (std::size_t i = 0; i < scene.views.size(); ++i) {
    const View& view = scene.views[i];
    const Lens lens = lens_of(view);
    if (!(lens.distortion_px > 0.01) || std::ranges::find(seen, view.camera_name) != seen.end()) continue;
    seen.push_back(view.camera_name);
    losses.push_back(
        {"/cameras/" + view.camera_name, "lens distortion",
         format("the picture without it, up to %.3g px elsewhere; run develop --undistort on the photographs",
                lens.distortion_px)});
  }
}

void surfaces_lose(const Scene& scene, std::vector<Loss>& losses) {
  for (const Surface& surface : scene.appearance.surfaces) {
    if (!surface.varying.empty())
      losses.push_back({"/surfaces/" + surface.id, "parameters that vary over the object by vertex, label or law",
                        "their value in `parameters`"});
  }
}

// A format that writes a file for each image meets the same camera and the same light several times.
void drop_repeated(std::vector<Loss>& losses) {
  std::vector<Loss> once;
  for (Loss& loss : losses)
    if (std::ranges::find(once, loss) == once.end()) once.push_back(std::move(loss));
  losses = std::move(once);
}

}  // namespace

Imported Exchange::read(const std::filesystem::path& path) const {
  throw Error(Exit::usage, path.string(), "scenes of " + std::string(name()) + " are written, not read",
              "import one of the formats that scene(1) lists");
}

const Exchange* find_exchange(std::string_view name) {
  const auto all = all_exchanges();
  const auto found = std::ranges::find_if(all, [&](const Exchange* e) { return e->name() == name; });
  return found == all.end() ? nullptr : *found;
}

const Exchange& importer_of(const std::filesystem::path& path) {
  std::string known;
  for (const Exchange* exchange : all_exchanges())
    for (const std::string_view extension : exchange->extensions()) {
      if (path.extension() == extension) return *exchange;
      known += (known.empty() ? "" : ", ") + std::string(extension);
    }
  throw Error(Exit::usage, path.string(), "is no scene that can be imported, by its name", "give one of " + known);
}

Exported export_scene(const Scene& scene, const Exchange& exchange) {
  Exported exported = exchange.write(scene);
  cameras_lose(scene, exported.losses);
  surfaces_lose(scene, exported.losses);
  if (scene.appearance.indirect_strength != 1)
    exported.losses.push_back(
        {"/mechanisms/transport.indirect", "a factor on light that was scattered more than once", "all of that light"});
  if (scene.appearance.vignetting_falloff != 0)
    exported.losses.push_back({"/mechanisms/optics.vignetting", "vignetting", "corners as bright as the middle"});
  if (!scene.bands.rgb) exported.losses.push_back({"/", "three wavelengths", "them as red, green and blue"});
  drop_repeated(exported.losses);
  return exported;
}

}  // namespace gonio::scene
