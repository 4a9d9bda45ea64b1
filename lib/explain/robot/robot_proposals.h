// Poses that could be recorded next on a robot: the board from the usual distance and from nearer and farther, squarely
// and from the sides, the camera turned about its axis. Private to robot/.
#pragma once
#include <vector>

#include "explain/robot/robot_findings.h"

namespace gonio::explain {

struct RobotProposal {
  Proposal told;
  ChainInput::View view;
  camera::BoardPose reference;  // of the board in the camera under the base model
  std::size_t like = 0;         // the recorded view whose noise and corners it has
};
// Of cameras on the arm (eye-in-hand); none of boards on it, which no plan can ask for. Where the arm's links and
// joints are known, only poses that the arm reaches, in the posture that is nearest to a recorded one; whether joint
// limits or things stand in the way is acquire's to find out.
std::vector<RobotProposal> robot_proposals(const RobotWork& work);

}  // namespace gonio::explain
