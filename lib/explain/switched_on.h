// What the manifest has switched on of mechanisms for one of the things that it describes.
#pragma once
#include <map>
#include <string>

#include "manifest/parameter.h"
#include "manifest/sections/forward.h"

namespace gonio::explain {

// Of the mechanisms that `domain` asks: parameters by id, for the entry `name` (a volume, a print). Where a mechanism
// names several, the value at this one's place in the list, or the only one.
std::map<std::string, manifest::Parameters> switched_on_for(const manifest::Document& document,
                                                            const std::string& domain, const std::string& name);

}  // namespace gonio::explain
