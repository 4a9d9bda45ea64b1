// A simulated arm with its controller, lamps and a turntable on loopback, and the URLs that reach them.
#pragma once
#include <string>
#include <vector>

#include "acquisition/desk/faults.h"
#include "acquisition/desk/modbus_desk.h"
#include "acquisition/desk/true_arm.h"
#include "acquisition/desk/ur_controller.h"
#include "acquisition/device/devices.h"

namespace gonio::tests {

struct DeskWorld {
  acquisition::desk::DeskClock clock;
  acquisition::desk::Faults faults;
  acquisition::desk::TrueArm arm;
  acquisition::desk::TrueLamps lamps;
  acquisition::desk::TrueTurntable table;
  acquisition::desk::UrController controller;
  acquisition::desk::ModbusDesk registers;

  static acquisition::desk::TrueArmSettings settings() {
    acquisition::desk::TrueArmSettings made;
    made.lower_rad.assign(6, -6.2832);
    made.upper_rad.assign(6, 6.2832);
    made.joints_rad = {0.1, -1.2, 1.3, -1.5, -1.6, 0.2};
    made.tool_pose = [](const acquisition::desk::JointAngles& q) {
      return acquisition::desk::ToolPose{0.3 + 0.1 * q[0], -0.2, 0.4, 0.1, -0.2, q[5]};
    };
    return made;
  }
  explicit DeskWorld(double time_factor = 200, std::uint64_t seed = 1)
      : clock(time_factor),
        faults(seed),
        arm(settings(), clock, faults),
        table(clock, 0.5, 50),
        controller(arm, faults),
        registers(faults) {
    registers.hold_arm(arm);
    for (int lamp = 0; lamp < 11; ++lamp) registers.hold_lamp(lamp, lamps, lamp);
    registers.hold_turntable(40, table, 1e-4);
  }
  std::string host() const { return "modbus://127.0.0.1:" + std::to_string(registers.port()); }
  // Waits are long enough for a busy machine where all is well, and as short as may be where a fault is met.
  std::string robot_url(const std::string& more = {}) const {
    return host() + "?rtde=" + std::to_string(controller.rtde_port()) +
           "&script=" + std::to_string(controller.script_port()) +
           "&dashboard=" + std::to_string(controller.dashboard_port()) + more;
  }
};

inline const std::vector<double> kSpeeds(6, 1.0), kAccelerations(6, 2.0);

inline std::vector<double> joints_of(const acquisition::desk::ArmSnapshot& snapshot) {
  return {snapshot.joints_rad.begin(), snapshot.joints_rad.end()};
}

inline double farthest(const std::vector<double>& a, const std::vector<double>& b) {
  double most = a.size() == b.size() ? 0 : 1e9;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

}  // namespace gonio::tests
