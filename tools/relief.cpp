// relief: height maps from noise, ridges and sinusoids, and a printer's ground noise fitted to measured ones
// (lib/relief/noise.h, ridges.h, ground_noise.h).
#include <iostream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "cli/program.h"
#include "manifest/value.h"
#include "relief/ground_noise.h"
#include "relief/map_options.h"
#include "relief/relief_options.h"
#include "relief/ridges.h"

namespace gonio::tools::relief {
namespace {

using namespace gonio::relief;
using manifest::Value;

double length(const cli::Invocation& call, const char* option, double otherwise) {
  return call.given(option) ? call.number(option) : otherwise;
}

double needed(const cli::Invocation& call, const char* option) {
  if (!call.given(option))
    throw Error(Exit::usage, std::string("--") + option, "is missing", "relief " + call.text("ACTION") + " needs it");
  return call.number(option);
}

RidgeShape ridge_asked(const cli::Invocation& call) {
  RidgeShape shape;
  shape.ridge_rad = needed(call, "angle"), shape.pitch_m = needed(call, "pitch");
  shape.crest_radius_m = length(call, "crest-radius", 0), shape.trough_radius_m = length(call, "trough-radius", 0);
  if (call.given("burr-share")) {
    shape.burr_share = call.number("burr-share");
    shape.burr_height_m = needed(call, "burr-height"), shape.burr_width_m = needed(call, "burr-width");
    shape.burr_length_m = length(call, "burr-length", shape.burr_width_m);
  }
  shape.ridges = static_cast<int>(call.integer("ridges"));
  shape.length_m = length(call, "length", 0);
  shape.seed = call.seed;
  return shape;
}

NoiseField noise_asked(const cli::Invocation& call) {
  NoiseField field;
  field.parts = parts_asked(call), field.seed = call.seed, field.periodic = call.flag("periodic");
  field.nx = field.ny = static_cast<int>(call.integer("points"));
  field.step_m = needed(call, "step");
  return field;
}

Relief made(const cli::Invocation& call) {
  const std::string& action = call.text("ACTION");
  if (action == "ridges") return ridges(ridge_asked(call), {static_cast<int>(call.integer("points-across")), 0});
  if (action == "sinusoid")
    return sinusoid(needed(call, "amplitude"), length(call, "wave-x", 0), length(call, "wave-y", 0),
                    static_cast<int>(call.integer("points-per-wave")));
  return noise_relief(noise_asked(call));
}

Exit generate(cli::Invocation& call) {
  const io::HeightMap map = map_of(made(call));
  io::write_height_map(call.text("to"), map);
  std::cout << manifest::print_json(Value::object({{"file", call.text("to")},
                                                   {"width", static_cast<std::int64_t>(map.width)},
                                                   {"height", static_cast<std::int64_t>(map.height)},
                                                   {"step_m", std::vector<double>{map.step_x_m, map.step_y_m}}}))
            << "\n"
            << std::flush;
  return Exit::done;
}

Exit fit_ground(cli::Invocation& call) {
  std::vector<io::HeightMap> maps;
  const std::vector<std::string> files = call.texts("MAP");
  for (const std::string& file : files) {
    call.note_input(file);
    maps.push_back(io::read_height_map(file, picture_asked(call)));
  }
  const GroundNoise ground =
      fit_ground_noise(maps, files, {.parts = call.given("parts") ? static_cast<int>(call.integer("parts")) : 0});
  if (call.given("html")) write_file(call.text("html"), ground_page(ground, files));
  if (call.given("to")) {
    NoiseField field;
    field.step_m = maps[0].step_x_m, field.seed = call.seed, field.periodic = call.flag("periodic");
    field.nx = static_cast<int>(maps[0].width), field.ny = static_cast<int>(maps[0].height);
    for (const GroundPart& part : ground.parts) field.parts.push_back({part.sq_m, part.cell_m});
    io::write_height_map(call.text("to"), map_of(noise_relief(field)));
  }
  std::cout << manifest::print_json(ground_value(ground, length(call, "layer", 0))) << "\n" << std::flush;
  return Exit::done;
}

void check(cli::Invocation& call) {
  const bool fits = call.text("ACTION") == "ground-noise";
  if (fits && call.texts("MAP").empty())
    throw Error(Exit::usage, "ground-noise", "has no map to look at", "name one: relief ground-noise map.x3p");
  if (!fits && !call.texts("MAP").empty())
    throw Error(Exit::usage, call.texts("MAP").front(), "is not read by " + call.text("ACTION"), "leave it out");
  if (!fits && !call.given("to"))
    throw Error(Exit::usage, "--to", "is missing", "name the map to write: --to relief.x3p");
  if (call.given("to") && !io::writes_height_map(call.text("to")))
    throw Error(Exit::usage, call.text("to"), "is no kind of height map that gonio writes",
                "name it .sur, .x3p or .exr");
  if (call.given("to")) check_writable(call.text("to"));
  if (call.text("ACTION") == "noise") noise_asked(call);
  if (call.text("ACTION") == "ridges") check_ridges(ridge_asked(call));
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "relief",
      .sentence = "make height maps of noise, ridges and waves, and learn a printer's noise from measured ones",
      .synopsis = {"noise --sq LENGTH --cell LENGTH --step LENGTH --to FILE [OPTION]...",
                   "ridges --angle ANGLE --pitch LENGTH --to FILE [OPTION]...",
                   "sinusoid --amplitude LENGTH --wave-x LENGTH --wave-y LENGTH --to FILE [OPTION]...",
                   "ground-noise [OPTION]... MAP..."},
      .options = relief_options(),
      .operands = {{.name = "ACTION",
                    .type = cli::Type::choice,
                    .help = "What to do.",
                    .choices = {"noise", "ridges", "sinusoid", "ground-noise"},
                    .required = true},
                   {.name = "MAP",
                    .type = cli::Type::input_file,
                    .help = "ground-noise: height maps of surfaces that were made flat.",
                    .repeat = true}},
      .reads = cli::Reads::none,
      .writes_manifest = false,
      .takes_seed = true,
      .references = {"Lewis, Algorithms for solid noise synthesis, SIGGRAPH 1989.",
                     "Frisvad & Wyvill, Fast high-quality noise, GRAPHITE 2007.",
                     "Luongo et al., Microstructure control in 3D printing with digital light processing, Computer "
                     "Graphics Forum 39, 2020.",
                     "Sykulski et al., The debiased Whittle likelihood, Biometrika 106, 2019."},
      .see_also = {"lobe(1)", "roughness(1)", "contrast(1)"},
      .check = check,
      .run = [](cli::Invocation& call) {
        return call.text("ACTION") == "ground-noise" ? fit_ground(call) : generate(call);
      }};
  return program;
}

}  // namespace gonio::tools::relief
