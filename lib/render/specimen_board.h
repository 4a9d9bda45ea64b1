// A built-in calibration scene: a ChArUco board under a distant lamp, seen from twelve sides through a lens that
// distorts. What the demo photographs to calibrate its virtual camera.
#pragma once
#include <filesystem>

#include "manifest/sections/forward.h"

namespace gonio::render {

manifest::Board specimen_board_section();

// Writes the board's drawing, board.png, into `out`. World: the board's middle is the origin, z towards the cameras.
manifest::Document board_specimen(const std::filesystem::path& out);

}  // namespace gonio::render
