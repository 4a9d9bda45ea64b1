// A picture for the eye.
#pragma once
#include "io/image.h"

namespace gonio::render {

// The first three channels of a linear picture (R, G, B; or Y three times) in sRGB, scaled so that the 99th percentile
// of the largest channel is white.
io::Image preview(const io::Image& linear);

}  // namespace gonio::render
