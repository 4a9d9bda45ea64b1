// The laboratory as plans, runs and pictures see it: the manifest's section "laboratory" with its arms' kinematics,
// limits and solids worked out. All of it is what is believed. Metres, radians, seconds, kilograms.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/laboratory/solid.h"
#include "geom/rigid.h"
#include "manifest/sections/forward.h"
#include "robot/kinematics.h"
#include "robot/limits.h"

namespace gonio::acquisition {

using Joints = std::vector<double>;           // one angle a joint, turns counted: not folded into one circle
using State = std::map<std::string, Joints>;  // where the arms stand, by name; an arm that is not named is at home

struct LaboratoryArm {
  std::string name, model;
  std::vector<robot::Link> links;                      // calibrated, where the laboratory has a calibration
  Rigid<frame::World, frame::Base> world_from_base{};  // the base from which the links count
  // From the links' last frame; the identity but for arms from a URDF, whose flange lies as its author put it.
  Rigid<frame::Tool, frame::Tool> last_from_tool{};
  // One a joint: the range that the section gives, or else the model's, and no more than the cable allows.
  std::vector<robot::JointLimit> limits;
  Joints home;
  std::vector<Solid> solids;  // of its links and of what it carries
};

struct Laboratory {
  std::map<std::string, LaboratoryArm> arms;
  std::vector<Solid> obstacles;
  double speed_m_per_s = 0.25, margin_m = 0.01, smallest_singular_m = 0.01;
  std::optional<std::pair<Vec3, Vec3>> workspace;  // corners of the box that no flange leaves
};

// Error(data) at the section's places: no section, unknown model, counts that are not the joints', a home outside its
// limits, limits that are empty, a solid's file that is none, an arm whose solids nobody knows.
Laboratory believed_laboratory(const manifest::Document& document);

// Where arm `name` stands; Error(internal) for counts of joints that are not the arm's.
const Joints& joints_of(const LaboratoryArm& arm, const State& state);
// The flange, and what sits on it. Error(data) for a camera or a lamp that is neither held nor placed.
Rigid<frame::World, frame::Tool> world_from_tool(const LaboratoryArm& arm, const Joints& joints);
// Where the links have to end (robot::flange) for the flange to be there: what inverse kinematics are asked.
Rigid<frame::Base, frame::Tool> wanted_of_links(const LaboratoryArm& arm,
                                                const Rigid<frame::World, frame::Tool>& world_from_tool);
// Where a held camera sits on its tool: as handeye measured it (section "mountings"), else as the laboratory believes.
std::optional<Rigid<frame::Tool, frame::Camera>> tool_from_camera(const manifest::Document& document,
                                                                  const std::string& camera);
Rigid<frame::World, frame::Camera> world_from_camera(const manifest::Document& document, const Laboratory& laboratory,
                                                     const std::string& camera, const State& state);
// A turntable that carries nothing and deforms something.
bool is_drive(const manifest::LaboratoryTurntable& table);
// How what stands on a turntable has moved since its angle was 0, world coordinates; not at all where the table is a
// drive. And how far what it deforms has gone through its shapes (scene/deformed.h), which takes one turn.
Rigid<frame::World, frame::World> turntable_motion(const manifest::LaboratoryTurntable& table, double angle_rad);
std::map<std::string, double> deformations(const manifest::LaboratoryTurntable& table, double angle_rad);
// Does it show the picture that a screen of its name shows?
bool is_screen(const manifest::Light& light);

// A standing lamp without a place of its own stands where its light does.
Vec3 lamp_position(const manifest::Document& document, const Laboratory& laboratory, const std::string& lamp,
                   const State& state);

// The limit that `joints` break, in words: `joint 3 at 171.2 deg, limit 170 deg`; empty: none.
std::string broken_limit(const LaboratoryArm& arm, const Joints& joints);

}  // namespace gonio::acquisition
