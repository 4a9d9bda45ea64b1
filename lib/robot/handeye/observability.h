// Directions in which the poses do not determine the mountings, in words.
//
// Information that is there in theory alone does not count: with parallel axes of motion the camera's place along the
// axis is free, yet noise tilts the axes a little, feigns information, and the fit returns a number. So every
// direction's information is held against what noise feigns: poses are disturbed once more by the estimated noises, and
// where the information of a direction grows by more than a quarter on the average, most of it was noise from the
// start. Directions whose information vanishes beside the rounding errors are free too.
#pragma once
#include <string>
#include <vector>

#include "robot/handeye/refinement.h"

namespace gonio::robot::handeye {

struct Observability {
  std::vector<std::string>
      unobservable;  // "translation of the camera along the tool's z axis"; empty: all is determined
  bool mount_from_camera = true, stand_from_board = true;  // determined as a whole?
};
Observability observe(const Setup& setup, const std::vector<View>& views, const std::vector<bool>& counts,
                      const Refined& refined);

// "the tool's z axis", or "the direction (0.58, 0.58, 0.58) of the tool's axes" where no axis is within 10 degrees.
std::string direction_words(Vec3 unit_direction, const std::string& frame);

}  // namespace gonio::robot::handeye
