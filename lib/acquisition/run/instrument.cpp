// See instrument.h.
#include "acquisition/run/instrument.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {
namespace {

using manifest::Document;

const manifest::Laboratory& section_of(const Document& d) {
  if (d.laboratory.entry.empty())
    throw Error(Exit::data, manifest::place(d, "/laboratory"), "is missing", "describe the instrument there");
  return d.laboratory.entry.front();
}

// Calls visit(kind, name, url) for every device.
template <class Visit>
void for_each_device(const Document& d, const Visit& visit) {
  const auto each = [&visit](const char* kind, const auto& devices) {
    for (const auto& [name, device] : devices) visit(kind, name, device.url);
  };
  const manifest::Laboratory& lab = section_of(d);
  each("robots", lab.robots);
  each("cameras", lab.cameras);
  each("lamps", lab.lamps);
  each("turntables", lab.turntables);
  each("screens", lab.screens);
}

std::string url_place(const Document& d, const std::string& kind, const std::string& name) {
  return manifest::place(d, "/laboratory/" + kind + "/" + name + "/url");
}

// With the URL that its driver opens: a register map stands beside it in the description.
std::map<std::string, manifest::LaboratoryRobot> reachable_robots(const Document& d) {
  auto robots = section_of(d).robots;
  for (auto& [name, robot] : robots) {
    if (robot.registers.empty() || robot.url.empty()) continue;
    const std::string user = "/laboratory/robots/" + name + "/registers";
    const std::string path = manifest::resolve(d, robot.registers, user).string();
    robot.url = with_query(robot.url, "registers", path, url_place(d, "robots", name));
  }
  return robots;
}

std::map<std::string, manifest::LaboratoryCamera> reachable_cameras(const Document& d) {
  auto cameras = section_of(d).cameras;
  for (auto& [name, camera] : cameras)
    if (!camera.url.empty())
      camera.url = camera_url(camera.url, camera.pixel_format, camera.trigger, url_place(d, "cameras", name));
  return cameras;
}

template <class Device, class Members, class Open>
void open_all(const Document& d, const std::string& kind, const Members& members,
              std::map<std::string, std::unique_ptr<Device>>& opened, const Open& open) {
  for (const auto& [name, member] : members) {
    const std::string at = url_place(d, kind, name);
    if (member.url.empty()) throw Error(Exit::data, at, "is missing", "give the URL that reaches it, or sim://");
    opened[name] = open(member.url, at);
  }
}

std::string told(const RobotState& state) {
  std::string out = state.standing ? "stands" : "moves";
  out += ", mode " + (state.mode.empty() ? std::string("unknown") : state.mode);
  if (state.protective_stop) out += ", PROTECTIVE STOP";
  if (state.emergency_stop) out += ", EMERGENCY STOP";
  if (!state.powered) out += ", no power";
  if (!state.remote_control) out += ", not under remote control";
  if (!state.temperature_K.empty())
    out += format(", joints up to %.0f deg C", *std::ranges::max_element(state.temperature_K) - 273.15);
  return out;
}

// `ask` says what the device answered; what it throws instead becomes the line.
template <class Ask>
void inspect_one(std::vector<std::string>& lines, bool* all_well, const std::string& what, const std::string& url,
                 const Ask& ask) {
  std::string answer;
  try {
    answer = url.starts_with("sim:") ? "is simulated" : ask();
  } catch (const Error& e) {
    answer = "DOES NOT ANSWER: " + e.problem() + (e.remedy().empty() ? "" : "; " + e.remedy());
    if (all_well != nullptr) *all_well = false;
  }
  lines.push_back(what + " (" + url + "): " + answer);
}

}  // namespace

Instrument open_instrument(const Document& d) {
  const manifest::Laboratory& lab = section_of(d);
  Instrument instrument;
  open_all(d, "robots", reachable_robots(d), instrument.robots, open_robot);
  open_all(d, "cameras", reachable_cameras(d), instrument.cameras, open_camera);
  open_all(d, "lamps", lab.lamps, instrument.lamps, open_lamp);
  open_all(d, "turntables", lab.turntables, instrument.turntables, open_turntable);
  open_all(d, "screens", lab.screens, instrument.screens, open_screen);
  return instrument;
}

void ask_all(Instrument& instrument) {
  for (auto& [name, robot] : instrument.robots) robot->state();
  for (auto& [name, table] : instrument.turntables) table->angle_rad();
  for (auto& [name, lamp] : instrument.lamps) {
    if (lamp->knows())
      lamp->is_on();
    else
      lamp->set(false);
  }
}

std::vector<std::string> urls_of(const Document& d) {
  std::vector<std::string> urls;
  for_each_device(d, [&urls](const char*, const std::string&, const std::string& url) {
    if (!url.empty()) urls.push_back(url);
  });
  return urls;
}

void turn_tables(Instrument& instrument, const std::map<std::string, double>& angles_rad) {
  for (const auto& [name, angle] : angles_rad) {
    const double reached = instrument.turntables.at(name)->turn_to(angle);
    if (std::abs(reached - angle) > 1e-3)
      throw Error(Exit::unavailable, "turntable " + name,
                  format("stands at %.3f deg, %.3f were asked", reached / degree, angle / degree));
  }
}

bool is_real(const Document& d) {
  bool real = false;
  for_each_device(d, [&](const char* kind, const std::string& name, const std::string& text) {
    if (text.empty()) return;
    const Url url = parse_url(text, url_place(d, kind, name));
    const bool here = url.host == "localhost" || url.host.starts_with("127.") || url.host == "::1";
    real = real || (url.scheme != "sim" && url.scheme != "folder" && !here);
  });
  return real;
}

std::vector<std::string> inspect(const Document& d, bool* all_well) {
  const manifest::Laboratory& lab = section_of(d);
  std::vector<std::string> lines;
  if (all_well != nullptr) *all_well = true;
  for (const auto& [name, robot] : reachable_robots(d))
    inspect_one(lines, all_well, "robot " + name, robot.url,
                [&, &n = name, &u = robot.url] { return told(open_robot(u, url_place(d, "robots", n))->state()); });
  for (const auto& [name, camera] : reachable_cameras(d))
    inspect_one(lines, all_well, "camera " + name, camera.url,
                [&, &n = name, &u = camera.url] { return open_camera(u, url_place(d, "cameras", n))->identity(); });
  for (const auto& [name, lamp] : lab.lamps)
    inspect_one(lines, all_well, "lamp " + name, lamp.url, [&, &n = name, &u = lamp.url] {
      const auto opened = open_lamp(u, url_place(d, "lamps", n));
      return std::string(!opened->knows()  ? "takes commands, and cannot be asked"
                         : opened->is_on() ? "is on"
                                           : "is off");
    });
  for (const auto& [name, table] : lab.turntables)
    inspect_one(lines, all_well, "turntable " + name, table.url, [&, &n = name, &u = table.url] {
      return format("stands at %.3f deg", open_turntable(u, url_place(d, "turntables", n))->angle_rad() * 57.29577951);
    });
  for (const auto& [name, screen] : lab.screens)
    inspect_one(lines, all_well, "screen " + name, screen.url, [&, &n = name, &u = screen.url] {
      open_screen(u, url_place(d, "screens", n));
      return std::string("is there");
    });
  return lines;
}

}  // namespace gonio::acquisition
