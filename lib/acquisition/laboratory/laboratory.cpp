// See laboratory.h: the section read into arms that can be computed with.
#include "acquisition/laboratory/laboratory.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "acquisition/laboratory/known_solids.h"
#include "acquisition/laboratory/solid_bodies.h"
#include "acquisition/laboratory/urdf_arm.h"
#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/robot.h"
#include "robot/ur_calibration.h"

namespace gonio::acquisition {
namespace {

using manifest::LaboratoryRobot;

struct Placed {  // a section and where it stands
  const manifest::Document& document;
  const LaboratoryRobot& robot;
  std::string pointer, place;
};

void check_count(std::size_t count, std::size_t joints, const std::string& place) {
  if (count != joints)
    throw Error(Exit::data, place,
                "has " + std::to_string(count) + " numbers, the arm " + std::to_string(joints) + " joints",
                "give one a joint");
}

robot::Arm arm_without_calibration(const Placed& at) {
  manifest::Robot section;
  section.model = at.robot.model;
  section.dh = at.robot.dh;
  return robot::arm_of(at.document, section, at.pointer);
}

robot::Arm calibrated_arm(const Placed& at, const robot::Arm& nominal) {
  if (at.robot.calibration.empty()) return nominal;
  manifest::Robot section;
  section.model = at.robot.model;
  section.dh = nominal.links;
  section.calibration = at.robot.calibration;
  return robot::arm_of(at.document, section, at.pointer);
}

std::vector<robot::JointLimit> given_limits(const Placed& at, std::vector<robot::JointLimit> limits) {
  if (!at.robot.limits) return limits;
  const manifest::JointLimits& given = *at.robot.limits;
  const auto put = [&](const std::vector<double>& numbers, double robot::JointLimit::*member, const char* name) {
    if (numbers.empty()) return;
    check_count(numbers.size(), limits.size(), at.place + "/limits/" + name);
    for (std::size_t i = 0; i < limits.size(); ++i) limits[i].*member = numbers[i];
  };
  put(given.lower_rad, &robot::JointLimit::lower_rad, "lower_rad");
  put(given.upper_rad, &robot::JointLimit::upper_rad, "upper_rad");
  put(given.speed_rad_per_s, &robot::JointLimit::speed_rad_per_s, "speed_rad_per_s");
  put(given.acceleration_rad_per_s2, &robot::JointLimit::acceleration_rad_per_s2, "acceleration_rad_per_s2");
  return limits;
}

void tighten_by_cable(const Placed& at, std::vector<robot::JointLimit>& limits) {
  if (!at.robot.cable) return;
  const manifest::CableSlack& cable = *at.robot.cable;
  check_count(cable.free_rad.size(), limits.size(), at.place + "/cable/free_rad");
  check_count(cable.slack_rad.size(), limits.size(), at.place + "/cable/slack_rad");
  for (std::size_t i = 0; i < limits.size(); ++i) {
    limits[i].lower_rad = std::max(limits[i].lower_rad, cable.free_rad[i] - cable.slack_rad[i]);
    limits[i].upper_rad = std::min(limits[i].upper_rad, cable.free_rad[i] + cable.slack_rad[i]);
  }
}

std::vector<robot::JointLimit> models_limits(const Placed& at, std::size_t joints) {
  for (const robot::ArmLimits& known : robot::known_limits())
    if (known.name == at.robot.model && known.joints.size() == joints) return known.joints;
  return std::vector<robot::JointLimit>(joints);
}

std::vector<robot::JointLimit> limits_of(const Placed& at, const std::vector<robot::JointLimit>& models) {
  std::vector<robot::JointLimit> limits = given_limits(at, models);
  tighten_by_cable(at, limits);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const robot::JointLimit& limit = limits[i];
    const std::string joint = "joint " + std::to_string(i + 1);
    if (!(limit.lower_rad < limit.upper_rad))
      throw Error(Exit::data, at.place + (at.robot.cable ? "/cable" : "/limits"),
                  joint + " may turn from " + shortest_text(limit.lower_rad) + " to " + shortest_text(limit.upper_rad) +
                      " rad, which is no range",
                  "give a lower limit below the upper one, and a cable that hangs free between them");
    if (!std::isfinite(limit.speed_rad_per_s) || !std::isfinite(limit.acceleration_rad_per_s2))
      throw Error(Exit::data, at.place + "/limits", joint + " has no limit of speed and acceleration",
                  "give speed_rad_per_s and acceleration_rad_per_s2: the model \"" + at.robot.model + "\" has none");
  }
  return limits;
}

// Where an arm of a known model stands when nobody says otherwise: upper arm upright, forearm level, tool down; no two
// of its axes in line.
Joints home_of(const Placed& at, std::size_t joints) {
  if (!at.robot.home_rad.empty()) {
    check_count(at.robot.home_rad.size(), joints, at.place + "/home_rad");
    return at.robot.home_rad;
  }
  if (at.robot.model.starts_with("ur") && joints == 6) return {0, -pi / 2, pi / 2, -pi / 2, -pi / 2, 0};
  if (at.robot.model.starts_with("abb-irb") && joints == 6) return {0, 0, 0, 0, pi / 2, 0};
  throw Error(Exit::data, at.place, "has no home_rad", "give the joint angles at which a run begins and ends");
}

struct Displacement {  // of a link of the calibrated arm against the nominal one, base coordinates, joints at zero
  Rigid<frame::Base, frame::Base> moved{};
};

Rigid<frame::Base, frame::Object> rigid_of(const robot::LinkFrame& frame) {
  return {quaternion_of(frame.rotation), frame.origin_m};
}

// Solids are known with all joints at zero. Where a calibration moves a link's frame by millimetres, the solid goes
// along. Frames between nearly parallel axes it throws metres away (ur_calibration.h), while the link stays where the
// link before it says.
std::vector<Displacement> displacements(const std::vector<robot::Link>& nominal,
                                        const std::vector<robot::Link>& links) {
  constexpr double with_the_link_m = 0.02, with_the_link_rad = 0.05;
  const Joints zero(links.size());
  const std::vector<robot::LinkFrame> before = robot::link_frames(nominal, zero),
                                      after = robot::link_frames(links, zero);
  std::vector<Displacement> moved(before.size());
  for (std::size_t i = 1; i < before.size(); ++i) {
    const auto change = rigid_of(after[i]) * inverse(rigid_of(before[i]));
    const bool near = norm(after[i].origin_m - before[i].origin_m) < with_the_link_m &&
                      norm(rotation_vector_of(change.rotation)) < with_the_link_rad;
    moved[i].moved = near ? change : moved[i - 1].moved;
  }
  return moved;
}

// "link-2" and "link-2-motor" -> 2.
int link_number(const std::string& name, std::size_t joints, const std::string& place) {
  int link = -1;
  if (name.starts_with("link-")) {
    const auto end = std::from_chars(name.data() + 5, name.data() + name.size(), link);
    if (end.ec != std::errc{} || (end.ptr != name.data() + name.size() && *end.ptr != '-')) link = -1;
  }
  if (link < 0 || link > static_cast<int>(joints))
    throw Error(Exit::data, place + "/name", "\"" + name + "\" names no link",
                "link-0 is the base, link-" + std::to_string(joints) + " the flange");
  return link;
}

std::vector<LinkSolid> link_solids(const Placed& at, std::size_t joints) {
  if (at.robot.links.empty()) {
    std::vector<LinkSolid> known = known_solids(at.robot.model);
    if (known.empty())
      throw Error(Exit::data, at.place, "has a model \"" + at.robot.model + "\" whose solids are not known",
                  "give the solids of its links as links");
    return known;
  }
  std::vector<LinkSolid> solids;
  for (std::size_t i = 0; i < at.robot.links.size(); ++i) {
    const manifest::SolidBody& body = at.robot.links[i];
    const std::string pointer = at.pointer + "/links/" + std::to_string(i);
    LinkSolid link{solid_of(at.document, body, pointer)};
    link.solid.link = link_number(body.name, joints, manifest::place(at.document, pointer));
    if (body.base_from_body) link.base_from_body = *body.base_from_body;
    solids.push_back(std::move(link));
  }
  return solids;
}

// Of the links, placed in the arm's frames. Known with all joints at zero, seen from `seen_from`.
std::vector<Solid> link_solids_in_frames(const Placed& at, const LaboratoryArm& arm,
                                         const std::vector<robot::Link>& nominal,
                                         const Rigid<frame::Base, frame::Base>& seen_from) {
  const std::vector<Displacement> moved = displacements(nominal, arm.links);
  const std::vector<robot::LinkFrame> frames = robot::link_frames(arm.links, Joints(arm.links.size()));
  std::vector<Solid> solids;
  for (LinkSolid& link : link_solids(at, arm.links.size())) {
    const auto i = static_cast<std::size_t>(link.solid.link);
    const auto in_frame = inverse(rigid_of(frames[i])) * (moved[i].moved * (seen_from * link.base_from_body));
    link.solid.placed = {in_frame.rotation, in_frame.translation_m};
    solids.push_back(std::move(link.solid));
  }
  return solids;
}

void put_solids(const Placed& at, std::vector<Solid> of_links, LaboratoryArm& arm) {
  arm.solids = std::move(of_links);
  for (std::size_t i = 0; i < at.robot.carries.size(); ++i) {
    const manifest::SolidBody& body = at.robot.carries[i];
    Solid solid = solid_of(at.document, body, at.pointer + "/carries/" + std::to_string(i));
    solid.link = static_cast<int>(arm.links.size());
    solid.carried = true;
    Rigid<frame::Tool, frame::Object> in_tool{};
    if (body.tool_from_body) in_tool = *body.tool_from_body;
    const auto in_last = arm.last_from_tool * in_tool;
    solid.placed = {in_last.rotation, in_last.translation_m};
    arm.solids.push_back(std::move(solid));
  }
  for (Solid& solid : arm.solids) {
    solid.arm = arm.name;
    solid.name = arm.name + "/" + solid.name;
  }
}

void put_known_arm(const Placed& at, LaboratoryArm& arm) {
  const robot::Arm nominal = arm_without_calibration(at);
  arm.links = calibrated_arm(at, nominal).links;
  arm.limits = limits_of(at, models_limits(at, arm.links.size()));
  put_solids(at, link_solids_in_frames(at, arm, nominal.links, {}), arm);
}

void put_described_arm(const Placed& at, LaboratoryArm& arm) {
  if (!at.robot.calibration.empty())
    throw Error(Exit::data, at.place + "/calibration", "is for arms whose rows are known, not for a URDF",
                "put it into the URDF, or name the model");
  DescribedArm described = described_arm(at.document, at.robot.urdf, at.pointer);
  arm.links = described.kinematics.arm.links;
  arm.world_from_base = arm.world_from_base * described.kinematics.base_from_first;
  arm.last_from_tool = described.kinematics.last_from_flange;
  arm.limits = limits_of(at, described.kinematics.limits);
  put_solids(at,
             at.robot.links.empty()
                 ? std::move(described.solids)
                 : link_solids_in_frames(at, arm, arm.links, inverse(described.kinematics.base_from_first)),
             arm);
  if (arm.solids.empty())
    throw Error(Exit::data, at.place + "/urdf", "has no collision shapes", "give the solids of its links as links");
}

LaboratoryArm arm_of(const manifest::Document& document, const std::string& name, const LaboratoryRobot& robot) {
  const std::string pointer = "/laboratory/robots/" + name;
  const Placed at{document, robot, pointer, manifest::place(document, pointer)};
  LaboratoryArm arm;
  arm.name = name;
  arm.model = robot.model;
  if (robot.world_from_base) arm.world_from_base = *robot.world_from_base;
  robot.model == "urdf" ? put_described_arm(at, arm) : put_known_arm(at, arm);
  arm.home = home_of(at, arm.links.size());
  if (const std::string broken = broken_limit(arm, arm.home); !broken.empty())
    throw Error(Exit::data, at.place + "/home_rad", broken, "give a home within the limits of joints and cable");
  return arm;
}

void put_limits(const manifest::LaboratoryLimits& limits, const std::string& place, Laboratory& laboratory) {
  laboratory.speed_m_per_s = limits.speed_m_per_s.value_or(laboratory.speed_m_per_s);
  laboratory.margin_m = limits.margin_m.value_or(laboratory.margin_m);
  laboratory.smallest_singular_m = limits.smallest_singular_m.value_or(laboratory.smallest_singular_m);
  if (limits.lower_m.empty() && limits.upper_m.empty()) return;
  if (limits.lower_m.size() != 3 || limits.upper_m.size() != 3)
    throw Error(Exit::data, place, "has one corner of the box that no flange leaves", "give lower_m and upper_m");
  const Vec3 low{limits.lower_m[0], limits.lower_m[1], limits.lower_m[2]};
  const Vec3 high{limits.upper_m[0], limits.upper_m[1], limits.upper_m[2]};
  if (!(low.x < high.x && low.y < high.y && low.z < high.z))
    throw Error(Exit::data, place, "lower_m is not below upper_m in every coordinate", "swap them");
  laboratory.workspace = {low, high};
}

// Of two devices behind one URL each would undo what the other does, and read back what the other is.
void one_url_each(const manifest::Document& document, const manifest::Laboratory& section) {
  std::map<std::string, std::string> owners;
  const auto each = [&](const std::string& kind, const auto& devices) {
    for (const auto& [name, device] : devices) {
      if (device.url.empty() || device.url.starts_with("sim:")) continue;
      const std::string own = "/laboratory/" + kind + "/" + name;
      const auto [owner, is_new] = owners.emplace(device.url, own);
      if (!is_new)
        throw Error(Exit::data, manifest::place(document, own + "/url"),
                    device.url + " is that of " + owner->second + ", too", "give every device its own");
    }
  };
  each("robots", section.robots);
  each("cameras", section.cameras);
  each("lamps", section.lamps);
  each("turntables", section.turntables);
  each("screens", section.screens);
}

}  // namespace

Laboratory believed_laboratory(const manifest::Document& document) {
  const std::string place = manifest::place(document, "/laboratory");
  if (document.laboratory.entry.empty()) throw Error(Exit::data, place, "is missing", "describe the laboratory");
  const manifest::Laboratory& section = document.laboratory.entry.front();
  one_url_each(document, section);
  Laboratory laboratory;
  for (const auto& [name, robot] : section.robots) laboratory.arms[name] = arm_of(document, name, robot);
  for (std::size_t i = 0; i < section.obstacles.size(); ++i) {
    const manifest::SolidBody& body = section.obstacles[i];
    Solid solid = solid_of(document, body, "/laboratory/obstacles/" + std::to_string(i));
    if (body.world_from_body) solid.placed = *body.world_from_body;
    laboratory.obstacles.push_back(std::move(solid));
  }
  if (section.limits) put_limits(*section.limits, place + "/limits", laboratory);
  return laboratory;
}

}  // namespace gonio::acquisition
