// Forward kinematics of serial arms after Denavit and Hartenberg (standard convention), and its derivatives with
// respect to joints and link parameters. Link i: T_i = Rz(q_i + theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i); base_from_tool =
// T_1 T_2 ... T_n is the flange. Denavit & Hartenberg 1955; Spong, Hutchinson & Vidyasagar 2006, equation 3.10. Metres,
// radians, double precision throughout: calibrated UR arms have link offsets of hundreds of metres that cancel
// (robot/ur_calibration.h).
//
// Derivatives are motions of the flange seen in the base: `shift_m` of its origin and `turn_rad`, a rotation vector
// applied on the left, R <- exp([turn]x) R, each per unit of what changes. They are exact, not differences. No gears,
// no stops (limits.h), no inverse kinematics (inverse/inverse_kinematics.h).
#pragma once
#include <span>
#include <string>
#include <vector>

#include "geom/dh_row.h"
#include "geom/rigid.h"
#include "manifest/sections/forward.h"

namespace gonio::robot {

using Link = DhRow;  // a_m, d_m, alpha_rad, theta_rad

struct Arm {
  std::string name;
  std::vector<Link> links;
  std::string source;  // of the numbers
};

struct Motion {
  Vec3 shift_m, turn_rad;
};
struct LinkMotions {
  Motion theta, d, a, alpha;
};

// `joints_rad`: one per link (not checked).
Rigid<frame::Base, frame::Tool> flange(std::span<const Link> links, std::span<const double> joints_rad);

// Of every link: frame 0 is the base, frame i stands behind i joints, the last is the flange.
struct LinkFrame {
  Mat3 rotation;  // of the frame's axes in the base
  Vec3 origin_m;
};
std::vector<LinkFrame> link_frames(std::span<const Link> links, std::span<const double> joints_rad);

// By each joint's angle; the same numbers as LinkMotions::theta.
std::vector<Motion> joint_motions(std::span<const Link> links, std::span<const double> joints_rad);
std::vector<LinkMotions> link_motions(std::span<const Link> links, std::span<const double> joints_rad);

// Lever arms of a weight at the flange: for each joint, the moment about its axis that a unit force downwards (base -z)
// at the flange's origin makes, in m; positive where it turns the joint forwards.
std::vector<double> weight_levers(std::span<const Link> links, std::span<const double> joints_rad);

// Arms known by name, with nominal values: ur3, ur3e, ur5, ur5e, ur10e, abb-irb-1600 (10/1.45), abb-irb-1600-1.2.
std::span<const Arm> known_arms();
// Error(data) at `place` that lists the names.
const Arm& known_arm(const std::string& name, const std::string& place);

}  // namespace gonio::robot
