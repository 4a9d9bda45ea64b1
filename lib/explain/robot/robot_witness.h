// Hand-eye recordings as a witness of what the corners of boards are said to show.
#pragma once
#include <vector>

#include "explain/domain.h"

namespace gonio::explain {

// Of every mounting of both documents: how far the board's poses in the images, seen through the arm, scatter about one
// place, as turns and as shifts of the board's middle. Both mountings are found anew for each document.
std::vector<Testimony> hand_eye_testimony(const manifest::Document& stated, const manifest::Document& mended);

}  // namespace gonio::explain
