// Nominal link parameters of known arms (kinematics.h). Universal Robots: the maker's published Denavit-Hartenberg
// tables, with the twist of 1.570796327 rad (nine decimals) that its controllers compute with. ABB IRB 1600: from the
// dimensions in the maker's product specification: axis 2 at 150 and 486.5 mm, upper arm 700 or 475 mm, forearm 600 mm,
// wrist to flange 65 mm; all joints at zero: upper arm upright, forearm level, flange's z forward and x downward
// (tool0).
#include "base/error.h"
#include "robot/kinematics.h"

namespace gonio::robot {
namespace {

Arm universal(const char* name, double d1, double a2, double a3, double d4, double d5, double d6) {
  constexpr double right = 1.570796327;
  return {name,
          {{0, d1, right, 0}, {a2, 0, 0, 0}, {a3, 0, 0, 0}, {0, d4, right, 0}, {0, d5, -right, 0}, {0, d6, 0, 0}},
          "Universal Robots, published Denavit-Hartenberg parameters"};
}

Arm irb_1600(const char* name, double upper_arm) {
  constexpr double right = pi / 2;
  return {name,
          {{0.15, 0.4865, -right, 0},
           {upper_arm, 0, 0, -right},
           {0, 0, -right, 0},
           {0, 0.6, right, 0},
           {0, 0, -right, 0},
           {0, 0.065, 0, pi}},
          "ABB, product specification IRB 1600, dimensions"};
}

}  // namespace

std::span<const Arm> known_arms() {
  static const std::vector<Arm> all = {
      universal("ur3", 0.1519, -0.24365, -0.21325, 0.11235, 0.08535, 0.0819),
      universal("ur3e", 0.15185, -0.24355, -0.2132, 0.13105, 0.08535, 0.0921),
      universal("ur5", 0.089159, -0.425, -0.39225, 0.10915, 0.09465, 0.0823),
      universal("ur5e", 0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996),
      universal("ur10e", 0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655),
      irb_1600("abb-irb-1600", 0.7),
      irb_1600("abb-irb-1600-1.2", 0.475),
  };
  return all;
}

const Arm& known_arm(const std::string& name, const std::string& place) {
  std::string names;
  for (const Arm& arm : known_arms()) {
    if (arm.name == name) return arm;
    names += arm.name + ", ";
  }
  throw Error(Exit::data, place, "\"" + name + "\" is no known arm", "one of " + names + "or dh with rows");
}

}  // namespace gonio::robot
