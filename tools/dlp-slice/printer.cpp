// The printer that is asked for, and what its process says of a job.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "manifest/sections/ground_noise.h"
#include "tools/dlp-slice/work.h"

namespace gonio::tools::dlp_slice {
namespace {

// Of prints/NAME/process.
constexpr std::array known{"exposure_s",   "bottom_exposure_s", "bottom_layers", "lift_m",
                           "lift_m_per_s", "retract_m_per_s",   "wait_s",        "resin_kg_per_m3"};

double process(const Work& work, const char* name, double otherwise) {
  const auto& all = work.call.document.prints.at(work.printer.name).process;
  const auto found = all.find(name);
  return found == all.end() ? otherwise : found->second;
}

std::string chosen(const cli::Invocation& call, const manifest::Document& from) {
  if (call.given("print")) {
    if (!from.prints.contains(call.text("print")))
      throw Error(Exit::data, manifest::place(from, "/prints"), "has no \"" + call.text("print") + "\"",
                  "name one of prints");
    return call.text("print");
  }
  if (from.prints.size() != 1)
    throw Error(
        Exit::data, manifest::place(from, "/prints"),
        from.prints.empty() ? "describes no printer" : "describes " + std::to_string(from.prints.size()) + " printers",
        from.prints.empty() ? "give pixel_m, width_px, height_px and layer_m under a name: --printer FILE"
                            : "choose one: --print NAME");
  return from.prints.begin()->first;
}

// What is said of the machine, and not of a job that it did.
manifest::Print machine_of(const manifest::Print& entry) {
  manifest::Print machine = entry;
  machine.microstructures.clear(), machine.parts.clear(), machine.figures.clear();
  machine.layers.clear(), machine.relief.clear(), machine.mesh.clear();
  return machine;
}

void take_from_file(Work& work) {
  const std::filesystem::path path = work.call.text("printer");
  work.call.note_input(path);
  const manifest::Document file = manifest::read_document(path);
  const std::string name = chosen(work.call, file);
  manifest::Print machine = machine_of(file.prints.at(name));
  if (!machine.ground.empty()) {
    manifest::GroundNoiseFit ground = file.ground_noises.at(machine.ground);
    ground.reliefs.clear(), ground.example.clear();
    work.call.document.ground_noises[machine.ground] = std::move(ground);
  }
  work.call.document.prints[name] = std::move(machine);
  work.printer.name = name;
  if (!work.call.has_document) work.call.document.name = path.string();  // for messages
}

std::vector<double> layers_of(const std::vector<LayerStep>& steps) {
  std::vector<double> layers;
  double z = 0;
  for (std::size_t s = 0; s + 1 < steps.size(); ++s)
    for (; z < steps[s + 1].from_m - 1e-9; z += steps[s].layer_m) layers.push_back(steps[s].layer_m);
  layers.push_back(steps.back().layer_m);
  return layers;
}

}  // namespace

void open_printer(Work& work) {
  if (work.call.given("printer"))
    take_from_file(work);
  else
    work.printer.name = chosen(work.call, work.call.document);
  manifest::Print& entry = work.entry();
  if (work.call.given("layer")) entry.layer_m = work.call.number("layer"), entry.layers_m.clear();
  if (work.call.given("layers")) {
    const std::vector<LayerStep> steps = layer_steps(work.call.text("layers"), "--layers");
    entry.layers_m = layers_of(steps), entry.layer_m = steps.front().layer_m;
  }
  work.printer = print::printer_of(work.call.document, work.printer.name);
  for (const auto& [name, value] : entry.process)
    if (std::ranges::find(known, name) == known.end()) {
      std::string names;
      for (const char* k : known) names += (names.empty() ? "" : ", ") + std::string(k);
      throw Error(Exit::data, work.printer.place + "/process/" + name, "is not known", "known are " + names);
    } else if (!(value >= 0))
      throw Error(Exit::data, work.printer.place + "/process/" + name, "is negative", "give 0 or more");
}

print::Job job_of(Work& work) {
  const manifest::Print& entry = work.entry();
  print::Job job;
  job.width_px = work.printer.width_px, job.height_px = work.printer.height_px;
  job.pixel_m = work.printer.pixel_m;
  if (work.printer.layers_m.empty()) job.layer_m = work.printer.layer_m;
  const std::string mirror = work.call.text("mirror");
  job.mirror_x = mirror.find('x') != std::string::npos, job.mirror_y = mirror.find('y') != std::string::npos;
  const auto take = [&](std::optional<double>& to, const char* name) {
    if (const auto found = entry.process.find(name); found != entry.process.end()) to = found->second;
  };
  take(job.exposure_s, "exposure_s"), take(job.bottom_exposure_s, "bottom_exposure_s");
  take(job.lift_m, "lift_m"), take(job.lift_m_per_s, "lift_m_per_s"), take(job.retract_m_per_s, "retract_m_per_s");
  take(job.resin_kg_per_m3, "resin_kg_per_m3");
  if (entry.process.contains("bottom_layers")) job.bottom_layers = static_cast<int>(process(work, "bottom_layers", 0));
  job.printer = work.printer.name;
  return job;
}

double time_of(const Work& work, std::size_t layers) {
  const double exposure = process(work, "exposure_s", 0), bottom = process(work, "bottom_exposure_s", exposure);
  const double bottoms = std::min(static_cast<double>(layers), process(work, "bottom_layers", 0));
  const double lift = process(work, "lift_m", 0), up = process(work, "lift_m_per_s", 0),
               down = process(work, "retract_m_per_s", up);
  const double move = (up > 0 ? lift / up : 0) + (down > 0 ? lift / down : 0) + process(work, "wait_s", 0);
  return bottoms * bottom + (static_cast<double>(layers) - bottoms) * exposure + static_cast<double>(layers) * move;
}

}  // namespace gonio::tools::dlp_slice
