// See lamp_switch.h.
#include "acquisition/run/lamp_switch.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "base/atomic_file.h"
#include "base/error.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {

void LampSwitch::set_one(const std::string& name, LampDevice& lamp, bool wanted) {
  for (int n = 1;; ++n) {
    try {
      lamp.set(wanted);
      if (lamp.is_on() == wanted) return;
      throw Error(Exit::unavailable, "lamp " + name, wanted ? "does not switch on" : "does not switch off");
    } catch (const Error& e) {
      throw_if_interrupted();
      if (e.code() != Exit::unavailable || n >= tries_) throw;
      failed_(name, e.problem());
    }
    try {
      if (wanted) lamp.set(false);
    } catch (const Error& e) {
      if (e.code() != Exit::unavailable) throw;  // what it does then shows at the next try
    }
  }
}

void LampSwitch::set(const std::vector<std::string>& on) {
  double settle_s = 0;
  for (const auto& [name, lamp] : instrument_.lamps) {
    const bool wanted = std::ranges::find(on, name) != on.end();
    if (lamp->is_on() == wanted) continue;
    set_one(name, *lamp, wanted);
    settle_s = std::max(settle_s, laboratory_.lamps.at(name).settle_s.value_or(0));
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(settle_s));
}

std::vector<std::string> LampSwitch::on() const {
  std::vector<std::string> names;
  for (const auto& [name, lamp] : instrument_.lamps)
    if (lamp->is_on()) names.push_back(name);
  return names;
}

bool LampSwitch::all_answer(const std::vector<std::string>& names) const {
  return std::ranges::all_of(names, [this](const std::string& name) {
    const auto lamp = instrument_.lamps.find(name);
    return lamp != instrument_.lamps.end() && lamp->second->answers();
  });
}

}  // namespace gonio::acquisition
