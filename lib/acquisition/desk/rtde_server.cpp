// RTDE as the controller speaks it, protocol 2, after the maker's guide; the packing of bytes is its own.
#include <optional>

#include "acquisition/desk/network_bytes.h"
#include "acquisition/desk/ur_controller.h"

namespace gonio::acquisition::desk {
namespace {

constexpr std::uint8_t output_recipe = 1;

using Bytes = NetworkBytes;

std::string framed(char type, const std::string& payload) {
  return Bytes()
      .u16(static_cast<unsigned>(payload.size() + 3))
      .u8(static_cast<unsigned char>(type))
      .text(payload)
      .all();
}

int register_of(const std::string& name) {
  const std::string before = "output_int_register_";
  if (name.compare(0, before.size(), before) != 0) return -1;
  const int number = std::atoi(name.c_str() + before.size());
  return number >= 0 && number < 48 ? number : -1;
}

// Appends the field; false where the controller has none of that name.
bool append_field(Bytes& out, std::string& type, const ArmSnapshot& arm, const std::string& name) {
  const std::uint32_t safety = (arm.protective_stop ? 1u << 2 : 0u) | (arm.emergency_stop ? 1u << 6 | 1u << 7 : 0u);
  const auto is = [&](const char* wanted, const char* its_type) {
    if (name != wanted) return false;
    type = its_type;
    return true;
  };
  if (is("timestamp", "DOUBLE")) return out.real(arm.time_s), true;
  if (is("actual_q", "VECTOR6D") || is("target_q", "VECTOR6D")) return out.six(arm.joints_rad), true;
  if (is("actual_qd", "VECTOR6D") || is("target_qd", "VECTOR6D")) return out.six(arm.speed_rad_per_s), true;
  if (is("actual_TCP_pose", "VECTOR6D")) return out.six(arm.tool), true;
  if (is("joint_temperatures", "VECTOR6D")) return out.six(arm.temperature_C), true;
  if (is("speed_scaling", "DOUBLE") || is("target_speed_fraction", "DOUBLE")) return out.real(1), true;
  if (is("robot_mode", "INT32")) return out.i32(arm.powered ? 7 : 3), true;
  if (is("safety_mode", "INT32")) return out.i32(arm.emergency_stop ? 7 : arm.protective_stop ? 3 : 1), true;
  if (is("robot_status_bits", "UINT32"))
    return out.u32((arm.powered ? 1u : 0u) | (arm.program_running ? 2u : 0u)), true;
  if (is("safety_status_bits", "UINT32")) return out.u32(safety == 0 ? 1u : safety | 1u << 10), true;
  if (is("runtime_state", "UINT32")) return out.u32(arm.program_running ? 2 : 1), true;
  if (is("actual_digital_output_bits", "UINT64")) return out.u32(0).u32(0), true;
  if (const int number = register_of(name); number >= 0) {
    type = "INT32";
    out.i32(arm.output_registers[static_cast<std::size_t>(number)]);
    return true;
  }
  type = "NOT_FOUND";
  return false;
}

std::vector<std::string> names_of(const std::string& list) {
  std::vector<std::string> names(1);
  for (const char c : list) c == ',' ? names.emplace_back() : names.back() += c, void();
  return names;
}

class RtdeSession {
 public:
  RtdeSession(Peer& peer, TrueArm& arm, Faults& faults) : peer_(peer), arm_(arm), faults_(faults) {}
  void run() {
    for (std::string pending;;) {
      pending += peer_.read(4096, flowing_ ? 1 : 50);
      while (pending.size() >= 3) {
        const std::size_t size = static_cast<unsigned char>(pending[0]) * 256u + static_cast<unsigned char>(pending[1]);
        if (size < 3) return;
        if (pending.size() < size) break;
        answer(pending[2], pending.substr(3, size - 3));
        pending.erase(0, size);
      }
      if (flowing_) send_data();
    }
  }

 private:
  void answer(char type, const std::string& payload) {
    if (type == 'V') {
      const bool two = payload.size() == 2 && payload[0] == 0 && payload[1] == 2;
      peer_.write(framed('V', Bytes().u8(two ? 1 : 0).all()));
    } else if (type == 'v') {
      peer_.write(framed('v', Bytes().u32(5).u32(9).u32(4).u32(1).all()));
    } else if (type == 'O' && payload.size() > 8) {
      names_ = names_of(payload.substr(8));
      const std::string types = rtde_types(names_);
      const bool known = types.find("NOT_FOUND") == std::string::npos;
      if (!known) names_.clear();
      peer_.write(framed('O', Bytes().u8(known ? output_recipe : 0).text(types).all()));
    } else if (type == 'S' || type == 'P') {
      flowing_ = type == 'S' && !names_.empty();
      peer_.write(framed(type, Bytes().u8(type == 'P' || flowing_ ? 1 : 0).all()));
    } else {
      const std::string why = "Unknown command", who = "RTDE";
      peer_.write(framed('M', Bytes().u8(static_cast<unsigned>(why.size())).text(why).u8(4).text(who).u8(1).all()));
    }
  }
  void send_data() {
    std::string packet = framed('U', Bytes().u8(output_recipe).text(rtde_data_bytes(arm_.now(), names_)).all());
    if (faults_.strikes(Fault::rtde_reset)) peer_.reset();
    if (faults_.strikes(Fault::rtde_dropped)) return;
    if (faults_.strikes(Fault::rtde_short)) packet = framed('U', packet.substr(3, packet.size() - 3 - 5));
    if (!held_ && faults_.strikes(Fault::rtde_reordered)) {
      held_ = packet;
      return;
    }
    peer_.write(packet);
    if (!held_) return;
    peer_.write(*held_);
    held_.reset();
  }

  Peer& peer_;
  TrueArm& arm_;
  Faults& faults_;
  bool flowing_ = false;
  std::vector<std::string> names_;
  std::optional<std::string> held_;
};

}  // namespace

std::string rtde_types(const std::vector<std::string>& names) {
  std::string types, type;
  Bytes nothing;
  for (const auto& name : names) {
    append_field(nothing, type, {}, name);
    types += (types.empty() ? "" : ",") + type;
  }
  return types;
}

std::string rtde_data_bytes(const ArmSnapshot& arm, const std::vector<std::string>& names) {
  Bytes out;
  std::string type;
  for (const auto& name : names) append_field(out, type, arm, name);
  return out.all();
}

void serve_rtde(Peer& peer, TrueArm& arm, Faults& faults) {
  RtdeSession(peer, arm, faults).run();
}

}  // namespace gonio::acquisition::desk
