// Which of a manifest's mechanisms move the corners of boards: whoever fits corners has to evaluate them, or to refuse.
#pragma once
#include <string>

#include "manifest/sections/forward.h"

namespace gonio::camera {

// Is it one that corners show, and is one of its numbers not neutral?
bool moves_corners(const std::string& mechanism, const manifest::MechanismUse& use);

}  // namespace gonio::camera
