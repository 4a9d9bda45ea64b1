// Filters over single pixels: colour filter arrays and the polarizers of a polarization camera. Super-pixels are 2 x 2
// and begin at pixel (0, 0), so that rows and columns of even number carry the first filter of each pair.
//
//   RGGB:  R G    GRBG:  G R    GBRG:  G B    BGGR:  B G    polarizers, degrees:   90  45
//          G B           B G           R G           G R                          135   0
#pragma once
#include <string>

#include "io/image.h"
#include "photograph/polarizers.h"

namespace gonio::render {

// One channel Y: of each pixel's R, G, B that which its filter passes. Error(data) for other names than the four, and
// for pictures without R, G, B.
io::Image bayer_mosaic(const io::Image& picture, const std::string& mosaic);

// The equations of a polarizer and of the grid are the sensor's (photograph/polarizers.h).
using photograph::behind_polarizer, photograph::polarizer_angle;

// Channels R, G, B of s0 and s1.R ... s2.B to R, G, B behind the polarizers: what a sensor of each band would record.
// Error(usage) for pictures without Stokes planes.
io::Image polarizer_mosaic(const io::Image& picture);

// Rec. 709 luminance of R, G, B as one channel Y: what stands in for the reading of a sensor without colour filters.
io::Image luminance(const io::Image& picture);

}  // namespace gonio::render
