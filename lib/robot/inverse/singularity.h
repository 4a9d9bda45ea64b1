// How far an arm stands from a singular posture, and from which.
#pragma once
#include <array>
#include <span>
#include <string>

#include "robot/inverse/inverse_kinematics.h"

namespace gonio::robot {

enum class Singular { shoulder, elbow, wrist, other };

struct Dexterity {
  // Smallest and largest singular value of the flange's motion per radian of the joints, in metres: turns of the flange
  // count by `length_m` (a turn by 0.1 rad as 0.1 length_m), so that both depend on that length, and on the flange's
  // own place. At the smallest, joints move by 1 / smallest_m rad for a metre (or 1 / length_m rad) in the worst
  // direction.
  double smallest_m = 0, largest_m = 0;
  std::array<double, 6> worst{};  // joints' motion of length 1 that moves the flange by the smallest only
  Singular nearest = Singular::other;
  std::string words;  // "wrist: axis 6 is 1.2 deg from in line with axis 4"
};

// `inverse` is that of `links`. `length_m` > 0: how far from the flange what it carries matters; 0.1 suits a camera.
Dexterity dexterity_at(const InverseKinematics& inverse, std::span<const Link> links, const Joints& joints_rad,
                       double length_m);

// The smallest alone, for loops.
double smallest_singular_m(std::span<const Link> links, const Joints& joints_rad, double length_m);

}  // namespace gonio::robot
