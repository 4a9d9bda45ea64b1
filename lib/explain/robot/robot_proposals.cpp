// See robot_proposals.h.
#include "explain/robot/robot_proposals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "manifest/codec.h"
#include "robot/handeye/viewpoint.h"
#include "robot/inverse/inverse_kinematics.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

using robot::handeye::Viewpoint;

// Distances are times the usual one.
constexpr Viewpoint settings[] = {{0, 0, 0, 1},     {0, 0, 90, 1},  {0, 0, 180, 1},   {0, 0, 0, 1.3},
                                  {0, 0, 0, 0.75},  {35, 0, 0, 1},  {35, 90, 0, 1},   {35, 180, 0, 1},
                                  {35, 270, 0, 1},  {35, 0, 90, 1}, {35, 180, 90, 1}, {50, 90, 0, 1.2},
                                  {50, 270, 0, 1.2}};

double turned(const std::vector<double>& a, const robot::Joints& b) {
  double sum = 0;
  for (std::size_t k = 0; k < b.size(); ++k) sum += std::abs(std::remainder(b[k] - a[k], 2 * pi));
  return sum;
}

// Joints that bring the tool there, nearest to those of a recorded view; false: out of reach.
bool reach(const ChainInput& input, const robot::InverseKinematics& inverse_of_arm, ChainInput::View& view) {
  const ChainInput::View& like = input.views[0];
  const auto tool_from_flange = inverse(like.base_from_tool) * robot::flange(input.links, like.joints_rad);
  double least = std::numeric_limits<double>::infinity();
  for (const robot::JointAnswer& answer : inverse_of_arm.solve(view.base_from_tool * tool_from_flange)) {
    if (!answer.exact) continue;
    for (const ChainInput::View& recorded : input.views)
      if (const double way = turned(recorded.joints_rad, answer.joints_rad); way < least) {
        least = way;
        view.joints_rad.assign(answer.joints_rad.begin(), answer.joints_rad.end());
      }
  }
  return std::isfinite(least);
}

}  // namespace

std::vector<RobotProposal> robot_proposals(const RobotWork& work) {
  const ChainInput& input = work.input;
  std::vector<RobotProposal> all;
  if (input.eye_to_hand) return all;
  const Vec3 middle{input.extent.middle_m.x, input.extent.middle_m.y, 0};
  std::vector<double> distances;
  std::size_t like = 0;
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    distances.push_back(norm(work.reference[v] * middle));
    if (input.views[v].corners.size() > input.views[like].corners.size()) like = v;
  }
  const bool arm_known = input.links.size() == 6 && input.views[like].joints_rad.size() == 6;
  std::optional<robot::InverseKinematics> arm;
  if (arm_known) arm.emplace(input.links);
  const double distance = stats::median(distances);
  for (Viewpoint from : settings) {
    from.distance_m *= distance;
    RobotProposal p;
    p.like = like;
    p.reference = pose_of(from, middle);
    p.view = input.views[like];
    p.view.image = "proposed";
    p.view.camera_from_board = p.reference;
    p.view.approach = {}, p.view.velocity = {}, p.view.acceleration = {};
    p.view.passes = false, p.view.warmer_K = 0, p.view.later_s = 0;
    const auto tool = input.base_from_fixed *
                      inverse(Rigid<frame::Object, frame::Object>{p.reference.rotation, p.reference.translation_m}) *
                      inverse(input.tool_from_hand);
    p.view.base_from_tool = {tool.rotation, tool.translation_m};
    for (ChainInput::Corner& corner : p.view.corners)
      camera::predict(input.intrinsics, p.reference, input.extent, input.warp, corner.board_m, corner.pixel);
    if (arm && !reach(input, *arm, p.view)) continue;
    manifest::Pose<frame::Camera, frame::Board> written;
    written.rotation = p.reference.rotation;
    written.translation_m = p.reference.translation_m;
    p.told.sentence = in_words(from);
    p.told.setup = manifest::Value::object(
        {{"images", manifest::Value(manifest::Value::Array{manifest::Value::object(
                        {{"camera", input.camera},
                         {"board", input.board},
                         {"camera_from_board", manifest::Codec<decltype(written)>::write(written)}})})}});
    all.push_back(std::move(p));
  }
  return all;
}

}  // namespace gonio::explain
