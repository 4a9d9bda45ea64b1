// Height maps in the manifest (gonio-manifest(5)), and what roughness, lobe and relief say of them, as the sections
// "reliefs" and "ground_noises".
#pragma once
#include <filesystem>
#include <string>

#include "manifest/sections/forward.h"
#include "relief/ground_noise.h"
#include "relief/measured.h"

namespace gonio::relief {

// What the manifest remembers of a picture's numbers.
io::HeightPicture picture_of(const manifest::ReliefMap& relief);
// What a map tells of its numbers goes into its entry.
void remember(manifest::ReliefMap& relief, const io::HeightMap& map, const io::HeightPicture& picture);
// Enters the map that lies at `path`, and what a picture's numbers mean; the relief's name. A relief whose file has
// changed since is entered anew: what was said of it no longer holds.
std::string enter_map(manifest::Document& document, const std::filesystem::path& path, const io::HeightMap& map,
                      const io::HeightPicture& picture = {});

manifest::ReliefTreatment treatment_entry(const Treatment& treatment, const Treated& surface);
void enter_roughness(manifest::ReliefMap& relief, const Measured& measured);
manifest::GroundNoiseFit ground_entry(const GroundNoise& ground, double layer_m);  // weights where layer_m > 0

}  // namespace gonio::relief
