// A micro-structure as the manifest or a command line states it, made ready.
#pragma once
#include <string>

#include "manifest/sections/forward.h"
#include "relief/microstructure.h"

namespace gonio::relief {

// MODEL:NAME=VALUE,NAME=VALUE,... with units as elsewhere (pitch_m=100um), "file" a file's id; of the model
// "expression" all behind the colon is the formula. `further` takes names that are no parameters, false: unknown.
// Error(usage) at `place`.
manifest::MicrostructureUse parse_microstructure(
    const std::string& text, const std::string& place,
    const std::function<bool(const std::string& name, const std::string& value)>& further);

// Parameters checked and filled in, the picture read (and kept by the function). `place` of the entry; Error(data).
ShareAt structure_of(const manifest::Document& document, const manifest::MicrostructureUse& use, double depth_m,
                     const std::string& place);

}  // namespace gonio::relief
