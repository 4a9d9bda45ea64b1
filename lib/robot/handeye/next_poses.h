// Which poses to add: candidates, each a move of the camera around the board (or of the board before the camera), by
// how much they would narrow the camera's place. No robot's reach, no collision is known here.
#pragma once
#include <string>
#include <vector>

#include "robot/handeye/refinement.h"

namespace gonio::robot::handeye {

// Up to `most` sentences, the best first; each later one assumes that the earlier poses were added. The narrowing is
// that of the board's middle as the camera's place predicts it: trace of the mount's covariance with turns at the
// board's distance.
std::vector<std::string> next_poses(const Setup& setup, const std::vector<View>& views, const std::vector<bool>& counts,
                                    const Refined& refined, std::size_t most = 3);

}  // namespace gonio::robot::handeye
