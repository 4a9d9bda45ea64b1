// The mechanisms of surfaces as edits of a manifest surface: what `surface.diffuse-roughness` and `surface.interface`
// do to the parameters that the models already understand. At the neutral values the edited surface reflects as before,
// to the last bit.
#pragma once
#include <string>

#include "manifest/sections.h"

namespace gonio::surface {

bool has_diffuse_base(const manifest::Surface& surface);  // "diffuse" or "coated-diffuse": what both edits apply to

// Error(data) at `place` for surfaces without a diffuse base.
manifest::Surface with_diffuse_roughness(manifest::Surface surface, double sigma_rad, const std::string& place);
manifest::Surface with_interface(manifest::Surface surface, double f0, double alpha, const std::string& place);

}  // namespace gonio::surface
