// What a simulated camera's three filters pass of the scene's three colours.
#pragma once
#include <string>
#include <vector>

#include "io/image.h"

namespace gonio::acquisition::desk {

// `light` with R, G and B as the filters read them: three rows of three, red's first; none: each its own. Other
// channels stay. Error(data) at `place` for another number of filters, and for light without these channels.
io::Image through_filters(const io::Image& light, const std::vector<double>& filters, const std::string& place);

}  // namespace gonio::acquisition::desk
