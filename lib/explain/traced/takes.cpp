// See takes.h.
#include "explain/traced/takes.h"

#include <algorithm>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "relighting/followed.h"
#include "relighting/recordings.h"
#include "relighting/scene_state.h"
#include "render/link.h"

namespace gonio::explain::traced {
namespace {

using relighting::Followed;

bool any(const manifest::Document& document, Followed least) {
  return relighting::has_recordings(document) && relighting::knows_lights(document) &&
         std::ranges::any_of(document.objects, [&](const manifest::Object& object) {
           return relighting::followed(document, object.surface) >= least;
         });
}

}  // namespace

std::vector<std::size_t> surfaces_in_question(const manifest::Document& document, const scene::Scene& scene) {
  std::vector<std::size_t> places;
  for (std::size_t s = 0; s < scene.appearance.surfaces.size(); ++s)
    if (relighting::followed(document, scene.appearance.surfaces[s].id) != Followed::fast &&
        std::ranges::any_of(scene.instances, [&](const auto& instance) { return instance.surface == s; }))
      places.push_back(s);
  return places;
}

bool wants_tracing(const manifest::Document& document) {
  return any(document, Followed::roughly);
}
bool beyond_the_fast_model(const manifest::Document& document) {
  return any(document, Followed::not_at_all);
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
