// polarizer.angle has no equation of its own: it turns axes (photograph/polarizer_array.h).
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& polarizer_angle();
}
