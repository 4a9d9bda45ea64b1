// A built-in scene for light-probe: a chromium ball under a sky with two windows. Metres; world z up.
#pragma once
#include <filesystem>

#include "manifest/sections/forward.h"

namespace gonio::render {

// A ball of 30 mm radius at the origin, before three cameras that see it in the middle of their pictures. Writes
// sky.exr (latitude-longitude radiance) into `out`.
manifest::Document mirror_ball_specimen(const std::filesystem::path& out);

}  // namespace gonio::render
