// The mountings that minimise the distance of corners in all images if the robot's poses are taken as exact: the
// customary refinement, here to be compared with. It pulls the camera after the robot's errors; refinement.h does not.
#pragma once
#include "robot/handeye/views.h"

namespace gonio::robot::handeye {

Solution minimise_reprojection(const Setup& setup, const std::vector<View>& views, const Solution& start);

}  // namespace gonio::robot::handeye
