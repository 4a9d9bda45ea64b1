// The scene of a cell: the object on its turntable, the screen, the room, the camera on its arc.
#pragma once
#include "glass/object.h"
#include "glass/set.h"

namespace gonio::glass {

// Fills cell.scene and adds to cell.facts; writes the files that the scene names below `folder`.
void set_the_stage(Cell& cell, const MadeObject& made, const SetWish& wish, const std::filesystem::path& folder,
                   Random& random);

}  // namespace gonio::glass
