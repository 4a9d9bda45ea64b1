// Colours for numbers, even in perceived lightness and safe for the colour-blind.
//
// Magnitudes: viridis (Smith & van der Walt 2015). Signed values: blue - white - red of equal lightness on both sides,
// the RdBu scheme of ColorBrewer (Harrower & Brewer 2003). Control points are interpolated linearly in sRGB codes.
#pragma once
#include <array>
#include <string>

namespace gonio::report {

using Colour = std::array<float, 3>;  // sRGB codes / 255

Colour magnitude_colour(double t);  // 0 .. 1, clipped; NaN is magenta
Colour signed_colour(double t);     // -1 .. 1, clipped, 0 is white; NaN is magenta
std::string hex(Colour colour);     // "#rrggbb"
bool is_dark(Colour colour);        // what is written upon it is light

}  // namespace gonio::report
