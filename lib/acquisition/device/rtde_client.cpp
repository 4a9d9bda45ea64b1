#include "acquisition/device/rtde_client.h"

#include <cmath>

#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

constexpr int rtde_tries = 3;

double rtde_one(const RtdeFields& fields, const std::string& name) {
  const double value = fields.at(name).at(0);
  if (!std::isfinite(value)) throw RtdeRefused("RTDE says that " + name + " is no number");
  return value;
}

std::array<double, 6> rtde_six(const RtdeFields& fields, const std::string& name) {
  std::array<double, 6> six{};
  const auto& numbers = fields.at(name);
  if (numbers.size() != 6) throw RtdeRefused("RTDE's " + name + " has not six numbers");
  for (std::size_t i = 0; i < 6; ++i) {
    if (!std::isfinite(numbers[i])) throw RtdeRefused("RTDE says that " + name + " is no number");
    six[i] = numbers[i];
  }
  return six;
}

std::string program_field(int program_register) {
  return "output_int_register_" + std::to_string(program_register);
}

}  // namespace

std::vector<std::string> rtde_names(int program_register) {
  return {"timestamp",          "actual_q",           "actual_qd",     "actual_TCP_pose",
          "joint_temperatures", "speed_scaling",      "robot_mode",    "safety_mode",
          "robot_status_bits",  "safety_status_bits", "runtime_state", program_field(program_register)};
}

RtdeState rtde_state(const RtdeFields& fields, int program_register) {
  RtdeState state;
  state.time_s = rtde_one(fields, "timestamp");
  state.speed_scaling = rtde_one(fields, "speed_scaling");
  state.joints_rad = rtde_six(fields, "actual_q");
  state.speed_rad_per_s = rtde_six(fields, "actual_qd");
  state.tool = rtde_six(fields, "actual_TCP_pose");
  state.temperature_C = rtde_six(fields, "joint_temperatures");
  state.robot_mode = static_cast<int>(rtde_one(fields, "robot_mode"));
  state.safety_mode = static_cast<int>(rtde_one(fields, "safety_mode"));
  state.robot_bits = static_cast<std::uint32_t>(rtde_one(fields, "robot_status_bits"));
  state.safety_bits = static_cast<std::uint32_t>(rtde_one(fields, "safety_status_bits"));
  state.runtime_state = static_cast<std::uint32_t>(rtde_one(fields, "runtime_state"));
  state.program = static_cast<int>(rtde_one(fields, program_field(program_register)));
  return state;
}

RtdeClient::RtdeClient(RtdeAddress address, std::string place)
    : address_(std::move(address)), place_(std::move(place)) {}

void RtdeClient::open() {
  flowing_ = false;
  last_time_s_.reset();
  connection_ = Connection(address_.host, address_.port, address_.timeout_s,
                           "RTDE at " + address_.host + ":" + std::to_string(address_.port));
  connection_.send(rtde_version_request(2), after(address_.timeout_s));
  if (!rtde_accepted(answer('V')))
    throw RtdeRefused("the controller's RTDE does not speak protocol 2 (before PolyScope 3.4?)");
  connection_.send(rtde_packet('v', {}), after(address_.timeout_s));
  version_ = rtde_version(answer('v'));
  const auto names = rtde_names(address_.program_register);
  connection_.send(rtde_outputs_request(address_.frequency_hz, names), after(address_.timeout_s));
  recipe_ = rtde_recipe(answer('O'), names);
}

std::string RtdeClient::answer(char type) {
  const auto until = after(address_.timeout_s);
  for (;;) {
    const RtdeHead head = rtde_head(connection_.receive(3, until));
    std::string payload = connection_.receive(head.payload_bytes, until);
    if (head.type == type) return payload;
    if (head.type == 'M')
      last_text_ = rtde_text(payload);
    else if (head.type != 'U' || type == 'U')
      throw RtdeRefused(
          format("an RTDE packet of type %d, awaited was '%c'", static_cast<unsigned char>(head.type), type));
    else if (Clock::now() >= until)
      throw Lost(connection_.what() + ": no answer in time");
  }
}

void RtdeClient::start() {
  if (flowing_) return;
  connection_.send(rtde_packet('S', {}), after(address_.timeout_s));
  if (!rtde_accepted(answer('S'))) throw RtdeRefused("the controller does not start to send RTDE data");
  flowing_ = true;
}

void RtdeClient::rest() {
  connection_.send(rtde_packet('P', {}), after(address_.timeout_s));
  if (!rtde_accepted(answer('P'))) throw RtdeRefused("the controller does not pause RTDE data");
  flowing_ = false;
}

RtdeState RtdeClient::next() {
  const RtdeState state = rtde_state(rtde_fields(answer('U'), recipe_), address_.program_register);
  if (last_time_s_ && !(state.time_s > *last_time_s_))
    throw RtdeRefused(format("RTDE packets out of order: the controller's clock says %.3f s after %.3f s", state.time_s,
                             *last_time_s_));
  last_time_s_ = state.time_s;
  return state;
}

// `work` anew with a new connection where the old one was lost. Work that made progress says so by resetting
// `failures`.
template <class Work>
auto RtdeClient::with_connection(const Work& work) {
  int failures = 0;
  for (;;) {
    std::string problem;
    try {
      const bool reopened = !connection_.is_open();
      if (reopened) open();
      return work(reopened, failures);
    } catch (const Lost& lost) {
      problem = lost.what();
    } catch (const RtdeRefused& refused) {
      problem = connection_.what() + ": " + refused.what();
    } catch (...) {
      connection_.close();  // the stream was left flowing
      throw;
    }
    connection_.close();
    ++reconnections_;
    if (++failures < rtde_tries) continue;
    if (!last_text_.empty()) problem += "; the controller said '" + last_text_ + "'";
    throw Error(
        Exit::unavailable, place_, problem + format(" (%d times in a row)", failures),
        "check that the controller is on, the network leads there and RTDE is enabled in its security settings");
  }
}

RtdeState RtdeClient::fresh() {
  return with_connection([this](bool, int&) {
    start();
    next();
    const RtdeState state = next();
    rest();
    return state;
  });
}

void RtdeClient::follow(const std::function<bool(const RtdeState&, bool)>& done) {
  with_connection([&](bool reopened, int& failures) {
    start();
    next();
    for (;;) {
      const RtdeState state = next();
      failures = 0;
      if (done(state, reopened)) break;
      reopened = false;
    }
    rest();
  });
}

}  // namespace gonio::acquisition
