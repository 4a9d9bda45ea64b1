// What people turn round: poses the wrong way, other programs' camera axes, mirrored pictures, left for right,
// millimetres for metres. Where pieces find no place, each such mistake is undone in turn, and the one under which they
// find one is named. Nothing is corrected in silence: the answer is a sentence.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "reassembly/place.h"

namespace gonio::reassembly {

// `cameras`: of each view, its name. Empty where no single mistake makes more pieces stand than `placement` has.
std::string mix_up(std::span<const View> views, std::span<const std::string> cameras, std::span<const Piece> pieces,
                   const PlaceWish& wish, const Placement& placement);

}  // namespace gonio::reassembly
