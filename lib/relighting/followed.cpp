// See followed.h.
#include "relighting/followed.h"

#include <algorithm>

#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/surface.h"
#include "relighting/scene_state.h"

namespace gonio::mechanism {
const Mechanism& surface_subsurface();
}

namespace gonio::relighting {
namespace {

// What has a roughness and neither a colour beneath nor an inside.
bool is_metal(const surface::Model& model) {
  return has_parameter(model, "alpha") && !has_parameter(model, "albedo") && !has_parameter(model, "sigma_a_per_m") &&
         !model.transmits();
}

}  // namespace

Followed followed(const manifest::Document& document, const std::string& name) {
  const auto found = document.surfaces.find(name);
  if (found == document.surfaces.end()) return Followed::fast;
  const manifest::Surface& surface = found->second;
  const surface::Model* model = surface::find(surface.model);
  if (model == nullptr) return Followed::fast;
  if (model->transmits() || surface.laws.contains("alpha")) return Followed::not_at_all;
  if (has_parameter(*model, "sigma_s_per_m")) return Followed::not_at_all;
  const auto alpha = surface.parameters.find("alpha");
  if (is_metal(*model))
    return alpha != surface.parameters.end() && alpha->second.scalar() < 0.02 ? Followed::not_at_all
                                                                              : Followed::roughly;
  const auto use = document.mechanisms.find(mechanism::surface_subsurface().id);
  const bool scatters =
      use != document.mechanisms.end() && (use->second.on.empty() || std::ranges::count(use->second.on, name) > 0);
  return scatters ? Followed::roughly : Followed::fast;
}

}  // namespace gonio::relighting
