// The secondary interface and the dashboard of the simulated controller: programs line by line until `end`, questions
// with one line of answer.
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <sstream>

#include "acquisition/desk/ur_controller.h"

namespace gonio::acquisition::desk {
namespace {

// A call's arguments: numbers in order, the list in brackets apart, those with a name by it.
struct CallText {
  std::string name;
  std::vector<double> list, plain;
  std::vector<std::pair<std::string, double>> named;
  std::optional<double> argument(const char* key, std::size_t at) const {
    for (const auto& [name_of, value] : named)
      if (name_of == key) return value;
    if (at < plain.size()) return plain[at];
    return {};
  }
};

class CallReader {
 public:
  explicit CallReader(const std::string& line) : text_(line) {}
  std::optional<CallText> read() {
    CallText call;
    call.name = word();
    if (call.name.empty() || !take('(')) return {};
    if (take(')')) return ended(call);
    do {
      if (take('[')) {
        do {
          const auto value = number();
          if (!value) return {};
          call.list.push_back(*value);
        } while (take(','));
        if (!take(']')) return {};
        continue;
      }
      const std::size_t back = at_;
      const std::string key = word();
      if (!key.empty() && take('=')) {
        const auto value = number();
        if (!value) return {};
        call.named.emplace_back(key, *value);
        continue;
      }
      at_ = back;
      const auto value = number();
      if (!value) return {};
      call.plain.push_back(*value);
    } while (take(','));
    if (!take(')')) return {};
    return ended(call);
  }

 private:
  std::optional<CallText> ended(const CallText& call) {
    skip();
    if (at_ != text_.size()) return {};
    return call;
  }
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  bool take(char c) {
    skip();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::string word() {
    skip();
    std::string found;
    while (at_ < text_.size() && (std::isalpha(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_' ||
                                  (!found.empty() && std::isdigit(static_cast<unsigned char>(text_[at_])))))
      found += text_[at_++];
    return found;
  }
  std::optional<double> number() {
    skip();
    char* end = nullptr;
    const double value = std::strtod(text_.c_str() + at_, &end);
    if (end == text_.c_str() + at_ || !std::isfinite(value)) return {};
    at_ = static_cast<std::size_t>(end - text_.c_str());
    return value;
  }
  const std::string text_;
  std::size_t at_ = 0;
};

std::optional<ArmStep> step_of_call(const CallText& call) {
  ArmStep step;
  if (call.name == "write_output_integer_register") {
    if (call.plain.size() != 2 || call.plain[0] < 0 || call.plain[0] > 47) return {};
    step.output_register = static_cast<int>(call.plain[0]);
    step.value = static_cast<int>(call.plain[1]);
    return step;
  }
  if (call.name == "stopj") {
    step.kind = ArmStep::Kind::brake;
    step.acceleration = call.argument("a", 0).value_or(0);
    if (step.acceleration <= 0) return {};
    return step;
  }
  if (call.name != "movej" || call.list.empty()) return {};
  step.kind = ArmStep::Kind::move;
  step.target_rad = call.list;
  step.acceleration = call.argument("a", 0).value_or(1.4);  // the manual's presets
  step.speed = call.argument("v", 1).value_or(1.05);
  if (step.acceleration <= 0 || step.speed <= 0) return {};
  return step;
}

std::string trimmed(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return {};
  return line.substr(first, line.find_last_not_of(" \t\r\n") - first + 1);
}

// "if read_output_integer_register(R) == V:" around all that follows.
std::optional<ArmStep> step_of_condition(const std::string& line) {
  const auto equals = line.find("==");
  if (line.rfind("if ", 0) != 0 || line.back() != ':' || equals == std::string::npos) return {};
  const auto call = CallReader(line.substr(3, equals - 3)).read();
  const auto value = CallReader("value(" + line.substr(equals + 2, line.size() - equals - 3) + ")").read();
  if (!call || !value || call->name != "read_output_integer_register" || call->plain.size() != 1 ||
      value->plain.size() != 1 || call->plain[0] < 0 || call->plain[0] > 47)
    return {};
  ArmStep step;
  step.kind = ArmStep::Kind::only_if;
  step.output_register = static_cast<int>(call->plain[0]);
  step.value = static_cast<int>(value->plain[0]);
  return step;
}

bool opens_block(const std::string& line) {
  return line.rfind("def ", 0) == 0 || line.rfind("if ", 0) == 0;
}

}  // namespace

std::vector<ArmStep> steps_of_script(const std::string& program) {
  std::vector<ArmStep> steps;
  std::istringstream lines(program);
  for (std::string line; std::getline(lines, line);) {
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty() || line == "end" || line.rfind("def ", 0) == 0) continue;
    const auto call = CallReader(line).read();
    const auto step = call ? step_of_call(*call) : step_of_condition(line);
    if (!step) return {};  // a program that does not compile does nothing at all
    steps.push_back(*step);
  }
  return steps;
}

void serve_script(Peer& peer, TrueArm& arm, Faults& faults) {
  // The real one talks all the time; clients that only send have to live with it.
  const std::string state_message("\x00\x00\x00\x05\x10", 5);
  peer.write(state_message);
  std::string pending, program;
  for (int depth = 0;;) {
    pending += peer.read(4096, 20);
    for (auto end = pending.find('\n'); end != std::string::npos; end = pending.find('\n')) {
      const std::string line = pending.substr(0, end + 1);
      pending.erase(0, end + 1);
      program += line;
      depth += opens_block(trimmed(line)) ? 1 : trimmed(line) == "end" ? -1 : 0;
      if (depth > 0) continue;
      if (faults.strikes(Fault::script_reset)) peer.reset();
      if (!faults.strikes(Fault::script_lost))
        if (const auto steps = steps_of_script(program); !steps.empty()) arm.run(steps);
      program.clear();
      depth = 0;
      peer.write(state_message);
    }
  }
}

void serve_dashboard(Peer& peer, TrueArm& arm) {
  peer.write("Connected: Universal Robots Dashboard Server\n");
  for (std::string pending;;) {
    pending += peer.read(4096, 20);
    for (auto end = pending.find('\n'); end != std::string::npos; end = pending.find('\n')) {
      const std::string asked = trimmed(pending.substr(0, end));
      pending.erase(0, end + 1);
      const ArmSnapshot now = arm.now();
      if (asked == "quit") {
        peer.write("Disconnected\n");
        return;
      }
      if (asked == "is in remote control")
        peer.write(now.remote_control ? "true\n" : "false\n");
      else if (asked == "robotmode")
        peer.write(now.powered ? "Robotmode: RUNNING\n" : "Robotmode: POWER_OFF\n");
      else if (asked == "unlock protective stop") {
        arm.clear_stops();
        peer.write("Protective stop releasing\n");
      } else
        peer.write("could not understand: '" + asked + "'\n");
    }
  }
}

UrController::UrController(TrueArm& arm, Faults& faults, const UrPorts& ports)
    : rtde_(ports.rtde, [&arm, &faults](Peer& peer) { serve_rtde(peer, arm, faults); }),
      script_(ports.script, [&arm, &faults](Peer& peer) { serve_script(peer, arm, faults); }),
      dashboard_(ports.dashboard, [&arm](Peer& peer) { serve_dashboard(peer, arm); }) {}

}  // namespace gonio::acquisition::desk
