// See takes.h.
#include "explain/traced/takes.h"

#include <algorithm>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "relighting/recordings.h"
#include "relighting/scene_state.h"
#include "render/link.h"

namespace gonio::mechanism {
const Mechanism& surface_subsurface();
}

namespace gonio::explain::traced {
namespace {

enum class Kind { plain, both, beyond };  // for the fast model alone, for both, for the tracer alone

// What has a roughness and neither a colour beneath nor an inside.
bool is_metal(const surface::Model& model) {
  return relighting::has_parameter(model, "alpha") && !relighting::has_parameter(model, "albedo") &&
         !relighting::has_parameter(model, "sigma_a_per_m") && !model.transmits();
}

Kind kind_of(const manifest::Document& document, const std::string& name) {
  const auto found = document.surfaces.find(name);
  if (found == document.surfaces.end()) return Kind::plain;
  const manifest::Surface& surface = found->second;
  const surface::Model* model = surface::find(surface.model);
  if (model == nullptr) return Kind::plain;
  if (model->transmits() || surface.laws.contains("alpha")) return Kind::beyond;
  if (relighting::has_parameter(*model, "sigma_s_per_m")) return Kind::beyond;
  const auto alpha = surface.parameters.find("alpha");
  if (is_metal(*model))
    return alpha != surface.parameters.end() && alpha->second.scalar() < 0.02 ? Kind::beyond : Kind::both;
  const auto use = document.mechanisms.find(mechanism::surface_subsurface().id);
  const bool scatters =
      use != document.mechanisms.end() && (use->second.on.empty() || std::ranges::count(use->second.on, name) > 0);
  return scatters ? Kind::both : Kind::plain;
}

bool any(const manifest::Document& document, Kind least) {
  return relighting::has_recordings(document) && relighting::knows_lights(document) &&
         std::ranges::any_of(document.objects, [&](const manifest::Object& object) {
           return kind_of(document, object.surface) >= least;
         });
}

}  // namespace

std::vector<std::size_t> surfaces_in_question(const manifest::Document& document, const scene::Scene& scene) {
  std::vector<std::size_t> places;
  for (std::size_t s = 0; s < scene.appearance.surfaces.size(); ++s)
    if (kind_of(document, scene.appearance.surfaces[s].id) != Kind::plain &&
        std::ranges::any_of(scene.instances, [&](const auto& instance) { return instance.surface == s; }))
      places.push_back(s);
  return places;
}

bool wants_tracing(const manifest::Document& document) {
  return any(document, Kind::both);
}
bool beyond_the_fast_model(const manifest::Document& document) {
  return any(document, Kind::beyond);
}

std::vector<std::string> behind_the_lens(const manifest::Document& document) {
  std::vector<std::string> ids;
  for (const render::Link* link : render::all_links())
    if (document.mechanisms.contains(link->mechanism().id)) ids.push_back(link->mechanism().id);
  return ids;
}
void check_reach(const manifest::Document& document) {
  const std::vector<std::string> ids = behind_the_lens(document);
  if (!ids.empty())
    throw Error(Exit::data, manifest::place(document, "/mechanisms/" + ids[0]),
                "acts behind the lens, where explain does not follow light that it traces", "leave it out");
}

}  // namespace gonio::explain::traced
