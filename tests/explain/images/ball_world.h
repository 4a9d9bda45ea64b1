// A ball on a table, two cameras, three lamps: rendered by the path tracer, recorded with noise, and handed over as
// what a user believes.
#pragma once
#include <string>
#include <vector>

#include "data.h"
#include "io/image.h"
#include "manifest/sections/forward.h"

namespace gonio::tests {

// `mechanisms`: the section's content. Images 00 .. 12 are two cameras times three lamps.
std::string ball_manifest(const std::string& mechanisms);

// Renders the manifest with `truth` switched on, sends it through the camera's chain, adds noise, and returns the
// manifest with `believed` instead.
manifest::Document record_ball(const ScratchFolder& folder, const std::string& truth, const std::string& believed,
                               int spp, std::uint64_t seed, std::vector<io::Image>* renderings = nullptr);

}  // namespace gonio::tests
