// See kinematics.h.
#include "robot/kinematics.h"

#include <cmath>

namespace gonio::robot {
namespace {

Vec3 x_of(const LinkFrame& frame) {
  return {frame.rotation(0, 0), frame.rotation(1, 0), frame.rotation(2, 0)};
}

Vec3 z_of(const LinkFrame& frame) {
  return {frame.rotation(0, 2), frame.rotation(1, 2), frame.rotation(2, 2)};
}

LinkFrame behind(const LinkFrame& before, const Link& link, double joint_rad) {
  const double ct = std::cos(joint_rad + link.theta_rad), st = std::sin(joint_rad + link.theta_rad);
  const double ca = std::cos(link.alpha_rad), sa = std::sin(link.alpha_rad);
  const Mat3 turn{{ct, -st * ca, st * sa, st, ct * ca, -ct * sa, 0, sa, ca}};
  return {before.rotation * turn, before.origin_m + before.rotation * Vec3{link.a_m * ct, link.a_m * st, link.d_m}};
}

Motion turn_about(Vec3 axis, Vec3 through_m, Vec3 flange_m) {
  return {cross(axis, flange_m - through_m), axis};
}

}  // namespace

std::vector<LinkFrame> link_frames(std::span<const Link> links, std::span<const double> joints_rad) {
  std::vector<LinkFrame> frames;
  frames.reserve(links.size() + 1);
  frames.emplace_back();
  for (std::size_t i = 0; i < links.size(); ++i) frames.push_back(behind(frames.back(), links[i], joints_rad[i]));
  return frames;
}

Rigid<frame::Base, frame::Tool> flange(std::span<const Link> links, std::span<const double> joints_rad) {
  const LinkFrame last = link_frames(links, joints_rad).back();
  return {quaternion_of(last.rotation), last.origin_m};
}

std::vector<LinkMotions> link_motions(std::span<const Link> links, std::span<const double> joints_rad) {
  const std::vector<LinkFrame> frames = link_frames(links, joints_rad);
  const Vec3 end = frames.back().origin_m;
  std::vector<LinkMotions> motions;
  for (std::size_t i = 0; i < links.size(); ++i) {
    // theta and d act about and along z of the frame before the link; a and alpha along and about x of the frame behind
    // it.
    const Vec3 z = z_of(frames[i]), x = x_of(frames[i + 1]);
    motions.push_back(
        {turn_about(z, frames[i].origin_m, end), {z, {}}, {x, {}}, turn_about(x, frames[i + 1].origin_m, end)});
  }
  return motions;
}

std::vector<Motion> joint_motions(std::span<const Link> links, std::span<const double> joints_rad) {
  std::vector<Motion> motions;
  for (const LinkMotions& m : link_motions(links, joints_rad)) motions.push_back(m.theta);
  return motions;
}

std::vector<double> weight_levers(std::span<const Link> links, std::span<const double> joints_rad) {
  std::vector<double> levers;
  // Virtual work: the moment of a force F at the flange about a joint is F times the flange's motion by that joint.
  for (const Motion& m : joint_motions(links, joints_rad)) levers.push_back(-m.shift_m.z);
  return levers;
}

}  // namespace gonio::robot
