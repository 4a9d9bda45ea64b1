// State of a Universal Robots controller over RTDE. Data packets flow only while somebody asks: what was sent before
// the question is never the answer to it. A packet that is short, holds something that is no number, or bears a time
// that is not after the one before ends the connection, and another is opened; after three in a row Error(unavailable)
// says why.
//
// A packet that was held up somewhere and comes late is older than its neighbours: of two packets in order the second
// cannot be such a one, and only it is believed.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "acquisition/device/connection.h"
#include "acquisition/device/rtde_packet.h"

namespace gonio::acquisition {

struct RtdeState {
  double time_s = 0, speed_scaling = 1;
  std::array<double, 6> joints_rad{}, speed_rad_per_s{}, tool{}, temperature_C{};  // tool: m, rotation vector in rad
  int robot_mode = 0, safety_mode = 0, program = 0;                                // program: the output register
  std::uint32_t robot_bits = 0, safety_bits = 0, runtime_state = 0;
};

struct RtdeAddress {
  std::string host;
  int port = 30004;
  int program_register = 24;  // output integer register (24 .. 47 are for external clients)
  double timeout_s = 2, frequency_hz = 125;
};

// The fields that RobotState needs. Refused where a number is none.
std::vector<std::string> rtde_names(int program_register);
RtdeState rtde_state(const RtdeFields& fields, int program_register);

class RtdeClient {
 public:
  RtdeClient(RtdeAddress address, std::string place);
  RtdeState fresh();  // began after the call; the stream rests afterwards
  // Every packet from now on, until `done` says so; it is told whether the connection was opened anew since the last.
  void follow(const std::function<bool(const RtdeState&, bool reopened)>& done);
  const std::string& controller_version() const { return version_; }
  std::int64_t reconnections() const { return reconnections_; }

 private:
  template <class Work>
  auto with_connection(const Work& work);
  void open();
  void start();
  void rest();
  std::string answer(char type);  // the payload of the next packet of this type; data and texts are passed over
  RtdeState next();
  RtdeAddress address_;
  std::string place_, version_, last_text_;
  Connection connection_;
  RtdeRecipe recipe_;
  std::optional<double> last_time_s_;
  bool flowing_ = false;
  std::int64_t reconnections_ = 0;
};

}  // namespace gonio::acquisition
