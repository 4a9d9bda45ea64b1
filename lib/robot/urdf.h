// Any arm from its URDF: the serial chain of revolute joints between two links, as Denavit and Hartenberg's rows with
// constant motions at both ends (axis_rows.h), joint limits, and the collision shapes that move with each row.
//
// base_from_flange(q) = base_from_first  flange(arm.links, q)  last_from_flange,   flange: the link called `tip`
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "io/urdf.h"
#include "robot/kinematics.h"
#include "robot/limits.h"

namespace gonio::robot {

struct CollisionBody {
  std::string link;        // of the URDF
  std::size_t behind = 0;  // moves with the frame behind so many rows: 0 the base, links.size() the flange
  Rigid<frame::Tool, frame::Object> frame_from_body;
  io::UrdfCollision shape;  // its origin is in frame_from_body already
};
// base_from_body(q) = base_from_first  flange(the first `behind` links, their joints)  frame_from_body

struct UrdfArm {
  Arm arm;
  Rigid<frame::Base, frame::Base> base_from_first;
  Rigid<frame::Tool, frame::Tool> last_from_flange;
  std::vector<std::string> joints;    // their names, in order
  std::vector<JointLimit> limits;     // URDF knows no accelerations
  std::vector<CollisionBody> bodies;  // of the chain's links, and of whatever is fixed to them
};

// `base`: empty for the root; a link on the chain, or fixed beside it; `tip`: empty where only one link ends a branch.
// Joints of other branches that are not fixed end what belongs to the arm. Error(data) at `place` for links that are
// not there or not one above the other, for joints that slide, float or mimic, and for a chain without joints.
UrdfArm arm_of_urdf(const io::Urdf& urdf, const std::string& base, const std::string& tip, const std::string& place);

// Where a mesh lies: "package://PACKAGE/REST" as PACKAGE/REST in the description's folder or one above it, or REST in
// such a folder that has a package.xml; "file://" and plain paths as they are. Error(no_input) where there is none.
std::filesystem::path mesh_of_urdf(const std::string& mesh, const std::filesystem::path& description);

}  // namespace gonio::robot
