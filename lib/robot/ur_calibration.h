// The factory calibration of a Universal Robots arm, as its controller keeps it in calibration.conf: corrections that
// are added to the nominal link parameters, actual = nominal + delta.
//
// delta_d of the joints 2 to 4 are huge, hundreds of metres, and cancel: for axes that are nearly parallel the common
// normal of Denavit and Hartenberg lies far away (Hayati 1983). They are kept as they are, in double precision, and
// never "repaired".
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "manifest/sections/forward.h"
#include "robot/kinematics.h"

namespace gonio::robot {

struct UrCalibration {
  std::array<double, 6> delta_theta_rad{}, delta_a_m{}, delta_d_m{}, delta_alpha_rad{};
  int status = 2;  // 0 not initialised, 1 not linearised, 2 linearised
};

// Error(data) for missing or incomplete rows, numbers that are not finite, and an arm that was never calibrated (status
// 0).
UrCalibration read_ur_calibration(const std::filesystem::path& path);
UrCalibration parse_ur_calibration(std::string_view text, const std::string& file);

// Error(data) at `place` for an arm that has not six joints.
Arm calibrated(const Arm& nominal, const UrCalibration& calibration, const std::string& place);

// The arm of the manifest's section "robots": known by name or given by its rows, with its calibration where it has
// one.
Arm arm_of(const manifest::Document& document, const std::string& robot);
// Of a section like it, at `pointer` of the document.
Arm arm_of(const manifest::Document& document, const manifest::Robot& section, const std::string& pointer);

}  // namespace gonio::robot
