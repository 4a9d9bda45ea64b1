// The surface that a relief amounts to where nobody sees its facets one by one: the facets' own model, rougher by the
// slopes of the map, for render and others to take instead of the relief.
//
// Slopes of the map and those that the facets have of their own add up: M = R diag(alpha_u^2, alpha_v^2) R' (normals.h)
// + alpha^2 I. Exact for Beckmann's distribution, whose slopes are normal; for GGX, which has no variance, the same
// rule moves the middle of the slopes, to a few per cent where the two are alike. The azimuth of the tangent is that of
// u. What a microfacet model leaves out of a relief (long masking, valleys, light by way of several facets beyond its
// own account of it) shows in `log1p_rms`, its distance from lobes that were traced; nothing is fitted to those.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "manifest/sections/surface.h"
#include "relief/lobe.h"
#include "relief/normals.h"

namespace gonio::relief {

// Of the models ID and beckmann-ID, where there are both, the one whose distribution is the likelier. Nothing, with
// `reason`, where the facets' model has no roughness, where they have an axis of their own, and where alpha exceeds 1.
struct RoughSurface {
  std::optional<manifest::Surface> surface;
  std::string reason;
  bool narrower = false;  // across the axis than the model can say: its least roughness there is alpha / 10
};
RoughSurface surface_of(const std::string& facets, const manifest::Parameters& parameters, const Normals& normals);

// A lobe of light that comes along `wi`.
struct TracedLobe {
  Vec3 wi;
  LobeTable lobe;
};
// Root mean square of ln(1 + 100 f cos cos), traced less that of the surface, over cells and bands up to 85 degrees
// from the normal. The surface is averaged over each cell. Nothing where it is smooth: then its lobe is a direction.
std::optional<double> log1p_rms(const manifest::Surface& surface, const std::vector<TracedLobe>& lobes);

}  // namespace gonio::relief
