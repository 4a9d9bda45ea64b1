// The mechanisms of lights as edits of manifest lights: what `light.direction`, `light.finite-size` and `light.ambient`
// do to the parameters that the models already understand. At the neutral values the edited lights shine as before, to
// the last bit.
#pragma once
#include <string>

#include "manifest/sections.h"

namespace gonio::light {

bool has_direction(const manifest::Light& light);  // directional, point, sphere
bool can_have_size(const manifest::Light& light);  // point, sphere

// light.direction: turns a directional light, or a lamp's position about `centre_m`, the middle of the scene
// (light/turn.h). Error(data) at `place` for lights that have neither.
manifest::Light with_direction(manifest::Light light, double tilt_x_rad, double tilt_y_rad, Vec3 centre_m,
                               const std::string& place);
// light.finite-size: a point becomes a sphere of this radius, its intensity on axis unchanged. Error(data) for other
// lights.
manifest::Light with_radius(manifest::Light light, double radius_m, const std::string& place);
// light.ambient: the light to add to the scene's; at zero radiance add none.
manifest::Light ambient(Rgb radiance);

}  // namespace gonio::light
