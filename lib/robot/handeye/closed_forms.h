// The closed forms of hand-eye calibration by name: tsai, park, horaud, andreff, daniilidis (A X = X B), shah, li
// (A X = Z B). Each is one source in this folder and one line of the table in closed_forms.cpp.
//
// They take every pair of samples as a motion, so that no order is preferred, and work on samples sorted by what they
// hold, so that their sums do not depend on the order in which samples were given. Near rotations of 180 degrees, where
// the axis of a motion has no sign, the sign is taken that agrees with a first rotation found without signs; small
// rotations count by their sine and are nowhere divided by it. They minimise algebraic distances, know no noise and
// give no uncertainty: refinement.h does. Where the motions do not determine a component it is returned as zero in some
// frame: observability.h tells.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "robot/handeye/samples.h"

namespace gonio::robot::handeye {

struct Motions;  // motions.h

struct ClosedForm {
  std::string_view name, equation, paper;
  Solution (*from_motions)(const Motions&);

  Solution solve(std::span<const PoseSample> samples) const;  // at least three
};
std::span<const ClosedForm> closed_forms();
const ClosedForm& closed_form(const std::string& name, const std::string& place);  // Error(usage) lists the names

}  // namespace gonio::robot::handeye
