// The options of calib-charuco, read into what the library takes.
#pragma once
#include <string>
#include <vector>

#include "camera/board.h"
#include "camera/calibrate_document.h"
#include "cli/program.h"

namespace gonio::tools::calib_charuco {

camera::CalibrationRequest request_of(cli::Invocation& call);
// Enters board and pictures of the quick form; Error(usage) for options that do not fit together.
void enter_command_line(cli::Invocation& call);
// The options that say how to fit, and those that describe the board.
std::vector<cli::Option> calibration_options();

}  // namespace gonio::tools::calib_charuco
