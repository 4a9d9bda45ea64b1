// screen.angle on what a screen's section states of its polarization.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& screen_angle();
}
