// The parameters of the robot domain: what each one moves, and the candidates they make. Private to robot/.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "explain/robot/pose_matrix.h"
#include "explain/robot/robot_problem.h"
#include "robot/chain/role.h"

namespace gonio::explain {

using robot::role_of;
using RobotRole = robot::ChainRole;
bool moves_camera_or_board(RobotRole::Part part);  // and with it the measured pose, not the chain
Eigen::Index slope_column(const RobotRole& role);  // of measured_slopes(), for those

struct RobotParameters {
  std::vector<Parameter> parameters;
  std::vector<RobotRole> roles;
  std::vector<std::size_t> base;
  std::vector<Candidate> candidates;
};
// Candidates have all parameters that these recordings could move, estimable or not.
RobotParameters robot_parameters(const ChainInput& input);

ChainState state_of(const ChainInput& input, const RobotParameters& parameters, std::span<const double> values);

}  // namespace gonio::explain
