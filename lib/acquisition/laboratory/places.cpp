// Where things of a laboratory are: flanges, cameras, lamps; and the words for a limit that is broken.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/laboratory/laboratory.h"
#include "base/error.h"
#include "base/text.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mounting.h"

namespace gonio::acquisition {
namespace {

template <class Part>
const Part& part_named(const manifest::Document& document,
                       const std::map<std::string, Part> manifest::Laboratory::*parts, const std::string& section,
                       const std::string& name) {
  const std::string pointer = "/laboratory/" + section;
  if (document.laboratory.entry.empty())
    throw Error(Exit::data, manifest::place(document, "/laboratory"), "is missing", "describe the laboratory");
  const auto& map = document.laboratory.entry.front().*parts;
  const auto found = map.find(name);
  if (found == map.end())
    throw Error(Exit::data, manifest::place(document, pointer + "/" + name), "is not described",
                "name one of the laboratory's " + section);
  return found->second;
}

const LaboratoryArm& arm_named(const Laboratory& laboratory, const std::string& name, const std::string& place) {
  const auto found = laboratory.arms.find(name);
  if (found == laboratory.arms.end())
    throw Error(Exit::data, place, "names no arm of the laboratory: \"" + name + "\"");
  return found->second;
}

Vec3 point_of(const std::vector<double>& numbers) {
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

std::string degrees(double rad) {
  return format("%.1f", rad * 180 / std::numbers::pi);
}

}  // namespace

const Joints& joints_of(const LaboratoryArm& arm, const State& state) {
  const auto found = state.find(arm.name);
  const Joints& joints = found == state.end() ? arm.home : found->second;
  if (joints.size() != arm.links.size())
    throw Error(Exit::internal, arm.name,
                "has " + std::to_string(arm.links.size()) + " joints and was given " + std::to_string(joints.size()) +
                    " angles");
  return joints;
}

Rigid<frame::World, frame::Tool> world_from_tool(const LaboratoryArm& arm, const Joints& joints) {
  return arm.world_from_base * robot::flange(arm.links, joints) * arm.last_from_tool;
}

Rigid<frame::Base, frame::Tool> wanted_of_links(const LaboratoryArm& arm,
                                                const Rigid<frame::World, frame::Tool>& world_from_tool) {
  return inverse(arm.world_from_base) * world_from_tool * inverse(arm.last_from_tool);
}

std::optional<Rigid<frame::Tool, frame::Camera>> tool_from_camera(const manifest::Document& document,
                                                                  const std::string& camera) {
  const auto& part = part_named(document, &manifest::Laboratory::cameras, "cameras", camera);
  for (const auto& [name, mounting] : document.mountings)
    if (mounting.tool_from_camera && mounting.camera == camera && mounting.robot == part.robot)
      return *mounting.tool_from_camera;
  if (part.tool_from_camera) return *part.tool_from_camera;
  return std::nullopt;
}

Rigid<frame::World, frame::Camera> world_from_camera(const manifest::Document& document, const Laboratory& laboratory,
                                                     const std::string& camera, const State& state) {
  const std::string place = manifest::place(document, "/laboratory/cameras/" + camera);
  const auto& part = part_named(document, &manifest::Laboratory::cameras, "cameras", camera);
  if (!part.robot.empty()) {
    const auto mount = tool_from_camera(document, camera);
    if (!mount)
      throw Error(Exit::data, place, "is held by " + part.robot + " without tool_from_camera",
                  "give it, or run handeye");
    const LaboratoryArm& arm = arm_named(laboratory, part.robot, place + "/robot");
    return world_from_tool(arm, joints_of(arm, state)) * *mount;
  }
  if (!part.world_from_camera)
    throw Error(Exit::data, place, "is neither held by a robot nor placed", "give robot or world_from_camera");
  return *part.world_from_camera;
}

bool is_screen(const manifest::Light& light) {
  return light.model == "screen" || light.model == "projector";
}

bool is_drive(const manifest::LaboratoryTurntable& table) {
  return table.carries.empty() && !table.deforms.empty();
}

Rigid<frame::World, frame::World> turntable_motion(const manifest::LaboratoryTurntable& table, double angle_rad) {
  if (is_drive(table)) return {};
  Rigid<frame::World, frame::Object> world_from_table;
  if (table.world_from_table) world_from_table = *table.world_from_table;
  const Rigid<frame::Object, frame::Object> turn{quaternion_of_rotation_vector({0, 0, angle_rad}), {}};
  return world_from_table * turn * inverse(world_from_table);
}

std::map<std::string, double> deformations(const manifest::LaboratoryTurntable& table, double angle_rad) {
  std::map<std::string, double> shares;
  for (const std::string& object : table.deforms) shares[object] = std::clamp(angle_rad / (2 * pi), 0.0, 1.0);
  return shares;
}

Vec3 lamp_position(const manifest::Document& document, const Laboratory& laboratory, const std::string& lamp,
                   const State& state) {
  const std::string place = manifest::place(document, "/laboratory/lamps/" + lamp);
  const auto& part = part_named(document, &manifest::Laboratory::lamps, "lamps", lamp);
  if (!part.robot.empty()) {
    if (part.in_tool_m.empty())
      throw Error(Exit::data, place, "is held by " + part.robot + " without in_tool_m", "give its position");
    const LaboratoryArm& arm = arm_named(laboratory, part.robot, place + "/robot");
    return world_from_tool(arm, joints_of(arm, state)) * point_of(part.in_tool_m);
  }
  if (!part.in_world_m.empty()) return point_of(part.in_world_m);
  const auto light = document.lights.find(part.light.empty() ? lamp : part.light);
  if (light != document.lights.end())
    if (const auto at = light->second.parameters.find("position_m"); at != light->second.parameters.end())
      return at->second.vector();
  throw Error(Exit::data, place, "is neither held by a robot nor placed", "give robot and in_tool_m, or in_world_m");
}

std::string broken_limit(const LaboratoryArm& arm, const Joints& joints) {
  if (joints.size() != arm.links.size())
    return std::to_string(joints.size()) + " joint angles, limit " + std::to_string(arm.links.size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string joint = "joint " + std::to_string(i + 1);
    if (!std::isfinite(joints[i])) return joint + " is not finite";
    const double low = arm.limits[i].lower_rad, high = arm.limits[i].upper_rad;
    // A millionth of a radian: what a limit loses when it is written in degrees.
    if (joints[i] < low - 1e-6) return joint + " at " + degrees(joints[i]) + " deg, limit " + degrees(low) + " deg";
    if (joints[i] > high + 1e-6) return joint + " at " + degrees(joints[i]) + " deg, limit " + degrees(high) + " deg";
  }
  return "";
}

}  // namespace gonio::acquisition
