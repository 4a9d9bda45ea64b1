// What programs that read height maps share: options that say what the numbers of a picture mean (io/height_map.h) and
// what is taken off the heights first (relief/areal.h), and the maps that a call is about.
//
// A call is about the operands MAP where there are any; each enters "files" and "reliefs" under the stem of its name.
// Else about the reliefs that --relief names, or all that the manifest has. What a picture's numbers mean says the
// command line, else "reliefs", which remembers what an earlier one said.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/program.h"
#include "io/height_map.h"
#include "manifest/sections/forward.h"
#include "relief/areal.h"

namespace gonio::cli {

std::vector<Option> picture_options();  // --step, --step-y, --unit, --channel
std::vector<Option> map_options();      // these, --levelling and the filters
Option relief_option();                 // --relief
Option map_operand();                   // MAP
io::HeightPicture picture_asked(const Invocation& call);
relief::Treatment treatment_asked(const Invocation& call);
// What the command line says of levelling and filters, else what the relief's figures rest on, else levelling alone.
relief::Treatment treatment_for(const Invocation& call, const manifest::ReliefMap& relief);

struct AskedMap {
  std::string relief;          // name in reliefs; empty: a file that is not there yet
  std::filesystem::path file;  // of the operand
};
// Error(no_input | data | usage) where there is none.
std::vector<AskedMap> maps_asked(const Invocation& call);
void check_maps(const Invocation& call);

struct NamedMap {
  std::string name;  // in reliefs
  std::string file;  // as messages and pages call it
  io::HeightMap map;
};
// Reads it and enters it. A relief whose file has changed since is entered anew: what was said of it no longer holds.
NamedMap read_map(Invocation& call, const AskedMap& asked);

}  // namespace gonio::cli
