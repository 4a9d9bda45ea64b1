// Cameras with a filter over each pixel. The pattern repeats every two pixels along both axes and begins at pixel
// (0, 0): "RGGB", "GRBG", "GBRG", "BGGR" name their colours row by row, "polarizers" is [90 45; 135 0] degrees
// (render/mosaic.h).
#pragma once
#include <string>

namespace gonio::camera {

inline constexpr const char* polarizers = "polarizers";

// Pixels from one to the next behind the same filter: 1 without a mosaic, else 2. Error(data) at `place` for patterns
// other than the above.
int filter_pitch(const std::string& mosaic, const std::string& place);

}  // namespace gonio::camera
