// Decodes the lines of a sequence (decode.h). For this room.
#pragma once
#include "scan/gray_decoder.h"

namespace gonio::scan {

// After decode_gray(), which has told the stripe, for axes that have lines.
void decode_lines(const DecodeRequest& request, const FrameReader& read, Codes& codes);

}  // namespace gonio::scan
