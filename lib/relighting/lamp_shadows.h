// Shadows of lamps that stand elsewhere than the base model has them. Which way a lamp is hidden from a point depends
// on the direction to it alone, as long as it stands behind all that hides it: one table of directions about the given
// one serves every shift and every turn of the lamp.
//   node (i, j) of a facet and a lamp: 1 where a ray along  n + offset_i t + offset_j b  meets nothing as far as the
//   lamp
// with n the direction to the given lamp from the facet's middle and t, b at right angles to it (geom/vector.h: Basis).
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "relighting/light_cache.h"
#include "relighting/scene_state.h"
#include "render/ray_caster.h"

namespace gonio::relighting {

// Tangents of angles, evenly about the given direction. Rays go to every fourth node; between nodes that agree nothing
// else is looked at.
inline constexpr double shadow_step = 0.01;
inline constexpr std::size_t shadow_stride = 4, shadow_across = 49, shadow_nodes = shadow_across * shadow_across;

// Adds the nodes of a table, and returns whether there are both kinds. `towards`: n; `open`: does a ray along this
// direction meet nothing?
bool cast_shadows_about(Vec3 towards, Vec3 normal, const std::function<bool(Vec3)>& open,
                        std::vector<std::uint8_t>& nodes);
// Of a lamp, summed over some points of a facet; a table of one kind is not added.
inline constexpr std::size_t shadow_origins = 4;
bool cast_shadows_about(const render::RayCaster& caster, std::span<const render::SurfacePoint* const> from,
                        const LightSource& light, std::vector<std::uint8_t>& nodes);

// The share of a lamp that is not hidden along `now`, where it is `visible` along `given` (unit): the table's word, but
// for turns that are smaller than what a pixel shows, where all sub-samples of the facet have spoken.
double visible_along(const std::uint8_t* nodes, Vec3 given, Vec3 now, double visible);
// The share of a table of single rays, between nodes by products of straight lines; nothing where `now` lies beyond it.
std::optional<double> openness_within(const std::uint8_t* nodes, Vec3 given, Vec3 now);
double openness_or_last(const std::uint8_t* nodes, Vec3 given, Vec3 now);  // as at the table's edge beyond it

// Radiance towards the eye for each unit of irradiance from there. Below the horizon nothing.
Rgb sent_back(const SurfaceState& surface, const Facet& facet, const Patch& patch, Vec3 to_light);

}  // namespace gonio::relighting
