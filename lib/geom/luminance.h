// Luminance of linear red, green and blue with the primaries of Rec. 709 (ITU-R BT.709-6, 3.3).
#pragma once
#include "geom/vector.h"

namespace gonio {

inline constexpr double luminance_weights[3] = {0.2126, 0.7152, 0.0722};

// In the precision of its arguments.
template <class Number>
constexpr Number luminance_of(Number red, Number green, Number blue) {
  return static_cast<Number>(luminance_weights[0]) * red + static_cast<Number>(luminance_weights[1]) * green +
         static_cast<Number>(luminance_weights[2]) * blue;
}
inline double luminance_of(Rgb colour) {
  return luminance_of(colour.x, colour.y, colour.z);
}

}  // namespace gonio
