// Mechanisms of surfaces as edits (surface/edits.h).
#include "surface/edits.h"

#include "base/error.h"

namespace gonio::surface {
namespace {

void require_diffuse_base(const manifest::Surface& surface, const std::string& place) {
  if (!has_diffuse_base(surface))
    throw Error(Exit::data, place, "surface of model \"" + surface.model + "\" has no diffuse base",
                "name the surfaces to change with \"on\"");
}

}  // namespace

bool has_diffuse_base(const manifest::Surface& surface) {
  return surface.model == "diffuse" || surface.model == "coated-diffuse";
}

manifest::Surface with_diffuse_roughness(manifest::Surface surface, double sigma_rad, const std::string& place) {
  require_diffuse_base(surface, place);
  surface.parameters["sigma_rad"] = sigma_rad;
  return surface;
}

manifest::Surface with_interface(manifest::Surface surface, double f0, double alpha, const std::string& place) {
  require_diffuse_base(surface, place);
  surface.model = "coated-diffuse";
  surface.parameters["f0"] = f0;
  surface.parameters["alpha"] = alpha;
  return surface;
}

}  // namespace gonio::surface
