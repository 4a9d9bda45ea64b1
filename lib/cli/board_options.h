// Options that describe a calibration board, the same in every program that looks for one.
#pragma once
#include <string>
#include <vector>

#include "camera/board.h"
#include "cli/program.h"

namespace gonio::cli {

std::vector<Option> board_options();  // --checkerboard, --charuco, --square, --marker, --dictionary, ...
bool describes_board(const Invocation& call);
// The board of --checkerboard or --charuco; Error(usage) for what makes no board.
camera::Board board_of(const Invocation& call);
// Enters it into the document as "board". Error(usage) where that describes its boards already.
void enter_described_board(Invocation& call);

}  // namespace gonio::cli
