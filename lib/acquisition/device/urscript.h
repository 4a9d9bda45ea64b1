// The text of a motion as Universal Robots' controllers take it on their secondary interface (port 30002). Each program
// bears a number that the controller writes into an output register when it begins (2 n) and ends (2 n + 1), so that
// the end of this very program is seen over RTDE, and neither that of an earlier one nor that of somebody else's.
// A motion begins only where the register still holds what it held when the motion was asked for: a program that was
// given up, stopped, and arrives late finds another mark there and moves nothing.
//
// movej moves all joints in proportion; its speed and acceleration are those of the leading axis, the one that turns
// most (URScript manual, movej). Joint i then has the share |d_i| / max |d| of them, and the fastest that breaks no
// joint's limit is min over i of limit_i max |d| / |d_i|. Without blending the arm stands at each end.
#pragma once
#include <span>
#include <string>
#include <vector>

namespace gonio::acquisition {

struct LeadingAxis {
  double speed_rad_per_s = 0, acceleration_rad_per_s2 = 0;
};
// Both 0 where nothing turns.
LeadingAxis leading_axis(std::span<const double> from, std::span<const double> to, std::span<const double> speeds,
                         std::span<const double> accelerations);

struct ProgramMark {
  int number = 0;  // 1 .. 2^29
  int output_register = 24;
  int before = 0;  // what the register held
  int begun() const { return 2 * number; }
  int ended() const { return 2 * number + 1; }
};

std::string motion_script(const ProgramMark& mark, std::span<const std::vector<double>> way,
                          std::span<const double> speeds, std::span<const double> accelerations);
// Replaces whatever program runs; brakes with that acceleration of the leading axis.
std::string stop_script(const ProgramMark& mark, double acceleration_rad_per_s2);

}  // namespace gonio::acquisition
