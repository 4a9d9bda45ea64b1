// Cameras and projectors of a rig, from the manifest.
#pragma once
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "scan/triangulate.h"

namespace gonio::scan {

// Of the first rig that has them all. Error(data) where none has.
std::vector<Station> stations_of(const manifest::Document& document, const std::vector<std::string>& names);

}  // namespace gonio::scan
