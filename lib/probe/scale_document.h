// The scale of the light that was found, against a photograph of the manifest. For probe_document.cpp.
#pragma once
#include <vector>

#include "probe/absolute_scale.h"
#include "probe/bright_lights.h"
#include "probe/probe_views.h"

namespace gonio::probe {

// Error(data) where the photograph or the tile cannot be used; no pixel is looked at.
void check_scale(const manifest::Document& document, const ScaleWish& wish);

// `map`: the surroundings, without `lights`; `faces`: of all views, with them.
Scale scale_of(const manifest::Document& document, const ProbeRequest& request, const BallViews& all,
               const std::vector<Facing>& faces, const std::vector<FoundLight>& lights, const Unwrapped& map);
// In the unit of the reference, the scale's error with its own.
FoundLight scaled(FoundLight light, const Scale& scale);

}  // namespace gonio::probe
