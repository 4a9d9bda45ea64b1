// A built-in laboratory: a UR5 that holds a camera over a ChArUco board on a table, under a lamp. All devices are
// simulated; what the arm does can be planned, carried out and calibrated without any instrument.
#pragma once
#include <filesystem>

#include "manifest/sections/forward.h"

namespace gonio::acquisition {

// Writes the board's drawing, board.png, into `out`. World: the board's middle is the origin, z towards the camera.
manifest::Document specimen_laboratory(const std::filesystem::path& out);

}  // namespace gonio::acquisition
