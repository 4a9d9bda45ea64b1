// Pictures for the eye.
#pragma once
#include <string>
#include <vector>

#include "io/image.h"

namespace gonio::render {

// The first three channels of a linear picture (R, G, B; or Y three times) in sRGB, scaled so that the 99th percentile
// of the largest channel is white.
io::Image preview(const io::Image& linear);

// The other layers of a rendering (film.h, layers.h), of those that it holds; sRGB, black where nothing was met:
//   s1 s2 s3             mean of R, G, B; blue - white - red from -m to m, m the 99th percentile of the largest of the
//                        three: one scale for all, so that they can be compared
//   depth                viridis, from the nearest (dark) to the farthest that is met
//   normal back-normal   0.5 + 0.5 n: x of the world is red, y green, z blue
struct LayerPreview {
  std::string layer;
  io::Image picture;
};
std::vector<LayerPreview> layer_previews(const io::Image& rendering);

}  // namespace gonio::render
