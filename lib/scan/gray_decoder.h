// Decodes the bits of a sequence (decode.h). For this room.
#pragma once
#include "scan/decode.h"

namespace gonio::scan {

using FrameReader = std::function<CameraFrame(std::size_t frame)>;

// Fills places, sigmas, reflected light, noise (where none is stated) and refusals.
void decode_gray(const DecodeRequest& request, const FrameReader& read, std::size_t white, std::size_t black,
                 Codes& codes);

}  // namespace gonio::scan
