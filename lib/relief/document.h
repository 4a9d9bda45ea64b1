// Height maps in the manifest (gonio-manifest(5)): which ones a call is about, and what roughness, lobe and relief say
// of them, as the sections "reliefs" and "ground_noises".
//
// A call is about the operands MAP where there are any; each enters "files" and "reliefs" under the stem of its name.
// Else about the reliefs that --relief names, or all that the manifest has. What a picture's numbers mean says the
// command line, else "reliefs", which remembers what an earlier one said.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/program.h"
#include "relief/ground_noise.h"
#include "relief/roughness_page.h"

namespace gonio::relief {

struct AskedMap {
  std::string relief;          // name in reliefs; empty: a file that is not there yet
  std::filesystem::path file;  // of the operand
};
// Error(no_input | data | usage) where there is none.
std::vector<AskedMap> maps_asked(const cli::Invocation& call);
void check_maps(const cli::Invocation& call);
cli::Option relief_option();
cli::Option map_operand();

struct NamedMap {
  std::string name;  // in reliefs
  std::string file;  // as messages and pages call it
  io::HeightMap map;
};
// What the manifest remembers of a picture's numbers.
io::HeightPicture picture_of(const manifest::ReliefMap& relief);
// Reads it and enters it. A relief whose file has changed since is entered anew: what was said of it no longer holds.
NamedMap read_map(cli::Invocation& call, const AskedMap& asked);
// Enters the map that lies at `path`, and what a picture's numbers mean; the relief's name.
std::string enter_map(manifest::Document& document, const std::filesystem::path& path, const io::HeightMap& map,
                      const io::HeightPicture& picture = {});

// What the command line says of levelling and filters, else what the relief's figures rest on, else levelling alone.
Treatment treatment_for(const cli::Invocation& call, const manifest::ReliefMap& relief);
manifest::ReliefTreatment treatment_entry(const Treatment& treatment, const Treated& surface);
void enter_roughness(manifest::ReliefMap& relief, const Measured& measured);
manifest::GroundNoiseFit ground_entry(const GroundNoise& ground, double layer_m);  // weights where layer_m > 0

}  // namespace gonio::relief
