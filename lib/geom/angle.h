// Angles are in radians everywhere; this is for what people write in degrees.
#pragma once
#include "geom/vector.h"

namespace gonio {

inline constexpr double degree = pi / 180;  // rad

}  // namespace gonio
