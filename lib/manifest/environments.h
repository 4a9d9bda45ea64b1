// Lights that refer to surroundings.
#pragma once
#include <string>

#include "manifest/document.h"
#include "manifest/sections/light.h"

namespace gonio::manifest {

// The light, its `environment` put in: that one's picture, and its scale times the light's own.
Light with_environment(const Document& document, const std::string& light);
// "/lights/NAME/file" or "/environments/NAME/file", whichever names the picture.
std::string picture_pointer(const Document& document, const std::string& light);

}  // namespace gonio::manifest
