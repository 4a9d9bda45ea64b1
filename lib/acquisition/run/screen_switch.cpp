// See screen_switch.h.
#include "acquisition/run/screen_switch.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {

void ScreenSwitch::show(const std::map<std::string, std::string>& wanted, const std::string& place) {
  for (const auto& [name, file] : wanted)
    if (!instrument_.screens.contains(name))
      throw Error(Exit::data, place, "shows a picture on \"" + name + "\", which is no screen of the laboratory",
                  "enter it in laboratory/screens");
  double settle_s = 0;
  for (const auto& [name, screen] : instrument_.screens) {
    const auto asked = wanted.find(name);
    const std::string file = asked == wanted.end() ? "" : asked->second;
    const auto now = shown_.find(name);
    if (now != shown_.end() && now->second == file) continue;
    screen->show(file.empty() ? "" : manifest::resolve(document_, file, place).string());
    shown_[name] = file;
    const auto entry = document_.laboratory.entry.front().screens.find(name);
    if (entry != document_.laboratory.entry.front().screens.end())
      settle_s = std::max(settle_s, entry->second.settle_s.value_or(0));
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(settle_s));
}

}  // namespace gonio::acquisition
