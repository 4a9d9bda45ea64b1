// See served_laboratory.h.
#include "acquisition/desk/served_laboratory.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "acquisition/desk/gige_camera.h"
#include "acquisition/desk/modbus_desk.h"
#include "acquisition/desk/screen_folder.h"
#include "acquisition/desk/true_state.h"
#include "acquisition/desk/ur_controller.h"
#include "base/assignment.h"
#include "base/error.h"
#include "base/quantity.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/file_paths.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/file.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"

namespace gonio::acquisition {
namespace {

using desk::Fault;
using manifest::Document;

constexpr double table_step_deg = 1e-6;  // that one of a turntable's registers stands for
constexpr int most_lamps = 256, most_tables = 64;

// The description with the scene's things: its files under names of their own.
Document staged(const Document& believed, const Document* scene) {
  Document whole = believed;
  if (scene == nullptr) return whole;
  Document things = *scene;
  manifest::move_to_folder(things, whole.folder);
  for (const auto& [id, file] : things.files) {
    if (whole.files.contains(id) && whole.files.at(id).sha256 != file.sha256)
      throw Error(Exit::data, manifest::place(*scene, "/files/" + id), "is another file than the laboratory's",
                  "give one of the two another name");
    whole.files[id] = file;
  }
  for (const auto& [name, light] : things.lights) whole.lights[name] = light;
  for (const auto& [name, surface] : things.surfaces) whole.surfaces[name] = surface;
  for (const auto& [name, camera] : things.cameras) whole.cameras.try_emplace(name, camera);
  for (const auto& [name, mesh] : things.meshes) whole.meshes[name] = mesh;
  for (const auto& [id, use] : things.mechanisms) whole.mechanisms[id] = use;
  whole.objects = things.objects.empty() ? whole.objects : things.objects;
  return whole;
}

}  // namespace

std::string fault_list() {
  std::string list;
  for (const desk::FaultKind& kind : desk::fault_kinds)
    list += (list.empty() ? "" : "; ") + std::string(kind.name) + ", " + kind.sentence;
  return list;
}

std::vector<std::pair<Fault, double>> parse_faults(const std::string& text, const std::string& place) {
  std::vector<std::pair<Fault, double>> wanted;
  for (const std::string& piece : pieces(text, ',')) {
    const auto [name, value] = parse_assignment(piece, place, "write NAME=PROBABILITY, as lamp-dark=2%");
    const auto found =
        std::ranges::find_if(desk::fault_kinds, [&n = name](const auto& kind) { return n == kind.name; });
    if (found == desk::fault_kinds.end()) {
      std::string names;
      for (const desk::FaultKind& kind : desk::fault_kinds)
        names += (names.empty() ? "" : ", ") + std::string(kind.name);
      throw Error(Exit::usage, place, "\"" + name + "\" is no fault", "there is " + names);
    }
    const double probability = parse_quantity(value, Dimension::ratio, place);
    if (!(probability >= 0 && probability <= 1))
      throw Error(Exit::usage, place, name + "=" + value + " is no probability", "0 to 1, or 0% to 100%");
    wanted.emplace_back(static_cast<Fault>(found - desk::fault_kinds.begin()), probability);
  }
  return wanted;
}

struct ServedLaboratory::Parts {
  struct Arm {
    std::unique_ptr<desk::UrController> controller;
    std::unique_ptr<desk::ModbusDesk> registers;
  };

  Parts(const Document& asked, const Document* scene, const Document* truth, const ServeOptions& options)
      : believed(asked),
        state(staged(asked, scene), truth, options.desk, options.pace),
        first_port(options.port),
        port(options.port) {
    for (const auto& [kind, probability] : options.faults) state.faults.set(kind, probability);
    const manifest::Laboratory& lab = state.section();
    for (const auto& [name, arm] : state.arms) serve_arm(name, *arm);
    if (!lab.lamps.empty() || !lab.turntables.empty()) serve_lamps_and_tables(lab);
    for (const auto& [name, camera] : lab.cameras) serve_camera(name);
    if (!lab.screens.empty()) serve_screens();
    rewrite();
  }

  int next_port() { return port == 0 ? 0 : port++; }

  void serve_arm(const std::string& name, desk::TrueArm& arm) {
    if (arm.now().joints_rad.size() != 6)
      throw Error(Exit::data, manifest::place(believed, "/laboratory/robots/" + name),
                  format("has %zu joints", arm.now().joints_rad.size()), "a served arm has 6; use sim:// for others");
    Arm& served = arms[name];
    served.registers = std::make_unique<desk::ModbusDesk>(state.faults, next_port());
    served.registers->hold_arm(arm);
    const int rtde = next_port(), script = next_port(), dashboard = next_port();
    served.controller = std::make_unique<desk::UrController>(arm, state.faults, desk::UrPorts{rtde, script, dashboard});
  }

  void serve_lamps_and_tables(const manifest::Laboratory& lab) {
    if (lab.lamps.size() > most_lamps || lab.turntables.size() > most_tables)
      throw Error(Exit::data, manifest::place(believed, "/laboratory"),
                  format("has %zu lamps and %zu turntables", lab.lamps.size(), lab.turntables.size()),
                  format("%d and %d can be served", most_lamps, most_tables));
    switches = std::make_unique<desk::ModbusDesk>(state.faults, next_port());
    for (const auto& [name, number] : state.lamp_number) switches->hold_lamp(number, state.lamps, number);
    int first = 0;
    for (const auto& [name, table] : state.tables) {
      switches->hold_turntable(first, *table, table_step_deg * std::numbers::pi / 180);
      first_register[name] = first;
      first += 4;
    }
  }

  // With ports that are given their folder has a name that stays, too, so that a run may go on after a new start.
  void serve_screens() {
    const std::string name = first_port == 0 ? "gonio-screens-of-" + std::to_string(::getpid())
                                             : "gonio-screens-at-" + std::to_string(first_port);
    screens = std::make_unique<desk::ScreenFolders>(state, std::filesystem::temp_directory_path() / name);
  }

  void serve_camera(const std::string& name) {
    if (!manifest::has_entry(state.document, "cameras", name))
      throw Error(Exit::data, manifest::place(believed, "/laboratory/cameras/" + name), "has no lens in cameras",
                  "enter it there under its name");
    const manifest::Camera& lens = state.document.cameras.at(name);
    desk::GigeSettings settings;
    settings.name = name;
    settings.width_px = static_cast<int>(lens.width_px);
    settings.height_px = static_cast<int>(lens.height_px);
    settings.format = state.format_of(name);
    // A picture that cannot be made is said now, and clients are told for how long to wait for one.
    const auto began = std::chrono::steady_clock::now();
    state.expose(name, {0.01, {}});
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    readout_s[name] = std::ceil(5 + 20 * took_s);
    cameras[name] = std::make_unique<desk::GigeCamera>(
        settings,
        [this, name](const Shot& shot, const PixelFormat& format) {
          const std::lock_guard<std::mutex> lock(state.busy);
          return state.expose(name, shot, &format);
        },
        state.faults);
  }

  // The servers' URLs in the description. Pictures are rendered after their exposure: that is said as time to read out.
  void rewrite() {
    manifest::Laboratory& lab = believed.laboratory.entry.front();
    const auto at = [](const desk::ModbusDesk& served) {
      return "modbus://127.0.0.1:" + std::to_string(served.port());
    };
    for (const auto& [name, arm] : arms) {
      lab.robots.at(name).registers.clear();
      lab.robots.at(name).url =
          at(*arm.registers) + format("?rtde=%d&script=%d&dashboard=%d", arm.controller->rtde_port(),
                                      arm.controller->script_port(), arm.controller->dashboard_port());
    }
    for (auto& [name, lamp] : lab.lamps) {
      const int number = state.lamp_number.at(name);
      lamp.url = at(*switches) + format("/coil/%d?answer=%d", number, number);
    }
    for (auto& [name, table] : lab.turntables)
      table.url = at(*switches) + format("/register/%d?scale=%gdeg", first_register.at(name), table_step_deg);
    for (auto& [name, screen] : lab.screens) screen.url = "folder://" + screens->folder_of(name).string();
    for (auto& [name, camera] : lab.cameras) {
      camera.url = "genicam://" + cameras.at(name)->address() + format("?readout=%gs", readout_s.at(name));
      camera.trigger = "software";
    }
  }

  Document believed;
  TrueState state;
  int first_port, port;  // port: the next one
  std::unique_ptr<desk::ScreenFolders> screens;
  std::map<std::string, Arm> arms;
  std::unique_ptr<desk::ModbusDesk> switches;
  std::map<std::string, int> first_register;
  std::map<std::string, double> readout_s;  // of cameras
  std::map<std::string, std::unique_ptr<desk::GigeCamera>> cameras;
};

ServedLaboratory::ServedLaboratory(const Document& believed, const Document* scene, const Document* truth,
                                   const ServeOptions& options)
    : parts_(std::make_unique<Parts>(believed, scene, truth, options)) {}
ServedLaboratory::~ServedLaboratory() = default;

Document ServedLaboratory::description() const {
  return parts_->believed;
}

std::int64_t ServedLaboratory::struck(Fault kind) const {
  return parts_->state.faults.struck(kind);
}

std::vector<std::string> ServedLaboratory::words() const {
  std::vector<std::string> lines;
  const manifest::Laboratory& lab = parts_->believed.laboratory.entry.front();
  for (const auto& [name, robot] : lab.robots) lines.push_back("robot " + name + ": " + robot.url);
  for (const auto& [name, camera] : lab.cameras) lines.push_back("camera " + name + ": " + camera.url);
  for (const auto& [name, lamp] : lab.lamps) lines.push_back("lamp " + name + ": " + lamp.url);
  for (const auto& [name, table] : lab.turntables) lines.push_back("turntable " + name + ": " + table.url);
  for (const auto& [name, screen] : lab.screens) lines.push_back("screen " + name + ": " + screen.url);
  return lines;
}

}  // namespace gonio::acquisition
