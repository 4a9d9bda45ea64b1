// An arm of Universal Robots: motion by URScript on the secondary interface, state by RTDE, held against the registers
// of its Modbus server, remote control asked of its dashboard server. Nothing is assumed: a motion is over when two
// packets in a row say that its own program has ended, that no program runs, that the arm stands, and that it stands
// where it was sent.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "acquisition/device/devices.h"

namespace gonio::acquisition {

struct UrAddress {
  std::string host;
  int rtde_port = 30004, script_port = 30002;
  std::optional<int> modbus_port = 502;       // nothing: not held against registers
  std::optional<int> dashboard_port = 29999;  // nothing: PolyScope X has none; remote control then shows in what runs
  int modbus_unit = 255, program_register = 24;
  double timeout_s = 2;  // of one answer
  double begin_s = 3;    // from sending a program to its beginning
  double stall_s = 5;    // without any motion while its program runs
};

// Opens no connection yet.
std::unique_ptr<RobotDevice> make_ur_robot(const UrAddress& address, const std::string& place);

}  // namespace gonio::acquisition
