// A built-in scene of glass: a bowl on a woven cloth under a sky with two windows. Metres; world z up.
#pragma once
#include <filesystem>

#include "io/image.h"
#include "io/ply.h"
#include "manifest/sections/forward.h"

namespace gonio::render {

// A closed bowl, turned on a lathe about z, standing on z = 0: outer radius and height of the rim, wall thickness; the
// profile is walked once around the glass, `sectors` around the axis. Normals are those of the profile.
io::TriangleMesh bowl(double radius_m, double thickness_m, int sectors);

// Radiance, W/(m^2 sr), latitude-longitude: a grey sky brighter towards the zenith, a dim floor, two windows.
io::Image sky_with_windows();

// Writes bowl.ply, cloth.exr (albedo) and sky.exr (latitude-longitude radiance) into `out`.
manifest::Document glass_specimen(const std::filesystem::path& out);

}  // namespace gonio::render
