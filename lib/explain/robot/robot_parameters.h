// The parameters of the robot domain: what each one moves, and the candidates they make. Private to robot/.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "explain/robot/pose_matrix.h"
#include "explain/robot/robot_problem.h"

namespace gonio::explain {

struct RobotRole {
  enum class Part { hand, fixed, pinhole, distortion, joint, a, d, sag, warp, scale, backlash, growth, lag };
  Part part = Part::hand;
  std::size_t index = 0;
};
// What a parameter of a mechanism moves here, by its name; nothing for names that this domain does not know.
std::optional<RobotRole> role_of(const std::string& parameter);
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
