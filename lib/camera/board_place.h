// Where a board stands in the world: the link from a board to an object of the scene ("frames": to the object's id,
// from the board's) says that it is printed on it, and the object's pose says the rest.
#pragma once
#include <optional>
#include <string>

#include "geom/rigid.h"
#include "manifest/sections/forward.h"

namespace gonio::camera {

std::optional<Rigid<frame::World, frame::Board>> world_from_board(const manifest::Document& document,
                                                                  const std::string& board);

// Images that show a board whose place is known are seen from where the calibration says: world_from_camera follows,
// and the plan that they were taken by remembers it as `by` that program (manifest/measured_views.h).
void place_images(manifest::Document& document, const std::string& by);

}  // namespace gonio::camera
