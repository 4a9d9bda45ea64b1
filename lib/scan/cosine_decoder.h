// Decodes the cosines of a sequence (decode.h). For this room.
#pragma once
#include "scan/gray_decoder.h"

namespace gonio::scan {

// As decode_gray(), for axes that have cosines.
void decode_cosines(const DecodeRequest& request, const FrameReader& read, Codes& codes);

}  // namespace gonio::scan
