// The upgraded sections of the robot domain: mountings with their sigmas and the parts of the scatter; where kinematics
// are named, the arm's rows and the tool poses that follow from them; board and camera as named.
#include <algorithm>
#include <cmath>

#include "base/progress.h"
#include "explain/robot/robot_findings.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mounting.h"
#include "manifest/sections/robot.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& board_scale();
const Mechanism& board_warp();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

using Part = RobotRole::Part;

bool is_named(const Problem& problem, const Explanation& e, const std::string& prefix) {
  return std::any_of(e.named.begin(), e.named.end(),
                     [&](std::size_t c) { return problem.candidates()[c].id().starts_with(prefix); });
}

template <class To, class From, class Start>
void write_pose(const Start& start, const std::array<double, 6>& change, const std::array<double, 6>& sigma,
                std::optional<manifest::Pose<To, From>>& section) {
  manifest::Pose<To, From> pose;
  pose.rotation = normalized(quaternion_of_rotation_vector({change[0], change[1], change[2]}) * start.rotation);
  pose.translation_m = start.translation_m + Vec3{change[3], change[4], change[5]};
  pose.sigma = manifest::PoseSigma{{sigma[0], sigma[1], sigma[2]}, {sigma[3], sigma[4], sigma[5]}};
  section = pose;
}

void upgrade_mounting(const RobotWork& work, const RobotFindings& findings, const Explanation& e,
                      manifest::Mounting& section) {
  const ChainState state = state_of(work.input, work.parameters, e.values);
  std::array<double, 6> hand{}, fixed{};
  for (std::size_t p = 0; p < work.parameters.roles.size(); ++p) {
    const RobotRole& role = work.parameters.roles[p];
    if (role.part == Part::hand) hand[role.index] = e.sigma[p];
    if (role.part == Part::fixed) fixed[role.index] = e.sigma[p];
  }
  if (work.input.eye_to_hand) {
    write_pose(work.input.tool_from_hand, state.hand, hand, section.tool_from_board);
    write_pose(work.input.base_from_fixed, state.fixed, fixed, section.base_from_camera);
  } else {
    write_pose(work.input.tool_from_hand, state.hand, hand, section.tool_from_camera);
    write_pose(work.input.base_from_fixed, state.fixed, fixed, section.base_from_board);
  }
  section.parts = findings.parts;
  section.robot_m = findings.robot_m;
  section.robot_rad = findings.robot_rad;
  const auto add = [](std::vector<std::string>& list, const std::vector<std::string>& more) {
    for (const std::string& text : more)
      if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
  };
  add(section.unobservable, findings.entangled);
  add(section.next, findings.next);
  add(section.outliers, work.outliers);
}

// The arm's rows, and the poses that follow from them; play, growth and lag, which no row holds, are in the poses.
void upgrade_arm(const RobotWork& work, const ChainState& state, manifest::Document& document) {
  if (!work.input.links.empty()) {
    manifest::Robot& arm = document.robots.at(work.input.robot);
    arm.dh = work.input.links;
    arm.calibration.clear();
    for (std::size_t i = 0; i < arm.dh.size() && i < 6; ++i) {
      arm.dh[i].theta_rad += state.joint_rad[i];
      arm.dh[i].a_m += state.a_m[i];
      arm.dh[i].d_m += state.d_m[i];
    }
  }
  for (const ChainInput::View& view : work.input.views) {
    const auto listed = manifest::index_of_image(document, view.image);
    if (!listed) continue;
    const auto tool = tool_pose(work.input, view, state);
    manifest::Pose<frame::Base, frame::Tool> pose;
    pose.rotation = tool.rotation;
    pose.translation_m = tool.translation_m;
    document.images[*listed].base_from_tool = pose;
  }
}

}  // namespace

void upgrade_robot(const RobotWork& work, const Problem& problem, const RobotFindings& findings, const Explanation& e,
                   manifest::Document& document) {
  const ChainState state = state_of(work.input, work.parameters, e.values);
  upgrade_mounting(work, findings, e, document.mountings.at(work.input.mounting));
  for (const std::string& text : findings.entangled) log(LogLevel::info, work.input.mounting + ": " + text);
  if (is_named(problem, e, "robot.")) upgrade_arm(work, state, document);
  if (is_named(problem, e, "lens.")) {
    manifest::Camera& section = document.cameras.at(work.input.camera);
    camera::store(state.intrinsics, section);
  }
  manifest::Board& board = document.boards.at(work.input.board);
  if (is_named(problem, e, mechanism::board_warp().id)) {
    board.warp["x_m"] = manifest::Parameter(state.warp.sag_x_m);
    board.warp["y_m"] = manifest::Parameter(state.warp.sag_y_m);
  }
  if (is_named(problem, e, mechanism::board_scale().id))
    document.mechanisms[mechanism::board_scale().id] = {
        {work.input.board}, {{"scale_x", state.scale[0]}, {"scale_y", state.scale[1]}}, {}};
}

}  // namespace gonio::explain
