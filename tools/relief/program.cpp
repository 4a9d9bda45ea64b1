// relief: height maps from noise, ridges and sinusoids, and a printer's ground noise fitted to measured ones
// (lib/relief/noise.h, ridges.h, ground_noise.h).
#include "cli/program.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "cli/height_maps.h"
#include "manifest/sections/ground_noise.h"
#include "manifest/sections/relief.h"
#include "relief/document.h"
#include "relief/ground_noise.h"
#include "tools/relief/made.h"
#include "tools/relief/options.h"
#include "tools/relief/page.h"

namespace gonio::tools::relief {
namespace {

using namespace gonio::relief;

// Writes the map and enters it; the relief's name.
std::string written(cli::Invocation& call, const std::filesystem::path& to, const char* kind, const Made& what) {
  const io::HeightMap map = map_of(what.relief);
  io::write_height_map(to, map);
  const std::string name = enter_map(call.document, to, map);
  manifest::ReliefMap& relief = call.document.reliefs.at(name);
  relief.kind = kind, relief.design = what.design;
  return name;
}

Exit generate(cli::Invocation& call) {
  const std::string& kind = call.text("ACTION");
  const std::filesystem::path to =
      call.given("to") ? std::filesystem::path(call.text("to")) : call.output_path(kind + ".x3p");
  written(call, to, kind.c_str(), made(call));
  return Exit::done;
}

Exit fit_ground(cli::Invocation& call) {
  const std::filesystem::path page = call.given("html") ? std::filesystem::path(call.text("html"))
                                     : call.out.empty() ? std::filesystem::path()
                                                        : call.output_path("report.html");
  std::vector<io::HeightMap> maps;
  std::vector<std::string> files, names;
  for (const cli::AskedMap& asked : cli::maps_asked(call)) {
    cli::NamedMap read = cli::read_map(call, asked);
    files.push_back(read.file), names.push_back(read.name);
    maps.push_back(std::move(read.map));
  }
  const GroundNoise ground =
      fit_ground_noise(maps, files, {.parts = call.given("parts") ? static_cast<int>(call.integer("parts")) : 0});
  manifest::GroundNoiseFit entry = ground_entry(ground, call.given("layer") ? call.number("layer") : 0);
  entry.reliefs = names;
  if (!page.empty()) write_file(page, ground_page(ground, files));
  if (call.given("to"))
    entry.example =
        written(call, call.text("to"), "noise", noise_like(ground, maps[0], call.seed, call.flag("periodic")));
  call.document.ground_noises[call.text("name")] = std::move(entry);
  return Exit::done;
}

void check(cli::Invocation& call) {
  const bool fits = call.text("ACTION") == "ground-noise";
  if (fits) cli::check_maps(call);
  if (!fits && !call.texts("MAP").empty())
    throw Error(Exit::usage, call.texts("MAP").front(), "is not read by " + call.text("ACTION"), "leave it out");
  if (!fits && !call.given("to") && call.out.empty())
    throw Error(Exit::usage, "--to", "is missing", "name the map to write: --to relief.x3p, or --out DIR");
  if (call.given("to") && !io::writes_height_map(call.text("to")))
    throw Error(Exit::usage, call.text("to"), "is no kind of height map that gonio writes",
                "name it .sur, .x3p or .exr");
  for (const char* option : {"to", "html"})
    if (call.given(option)) check_writable(call.text(option));
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
                   "ground-noise [OPTION]... [MAP... | -i FILE | manifest.json]"},
      .options = options(),
      .operands = {{.name = "ACTION",
                    .type = cli::Type::choice,
                    .help = "What to do.",
                    .choices = {"noise", "ridges", "sinusoid", "ground-noise"},
                    .required = true},
                   cli::map_operand()},
      .standalone = {"sq", "angle", "amplitude"},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"files", "reliefs"},
      .sections_written = {"files", "reliefs", "ground_noises"},
      .files = {{"noise.x3p, ridges.x3p, sinusoid.x3p", "the map that was made, where --to names no other place"},
                {"report.html", "ground-noise: the report"}},
      .references = {"Lewis, Algorithms for solid noise synthesis, SIGGRAPH 1989.",
                     "Frisvad & Wyvill, Fast high-quality noise, GRAPHITE 2007.",
                     "Luongo et al., Microstructure control in 3D printing with digital light processing, Computer "
                     "Graphics Forum 39, 2020.",
                     "Sykulski et al., The debiased Whittle likelihood, Biometrika 106, 2019."},
      .see_also = {"lobe(1)", "roughness(1)", "contrast(1)", "gonio-manifest(5)"},
      .check = check,
      .run = [](cli::Invocation& call) {
        return call.text("ACTION") == "ground-noise" ? fit_ground(call) : generate(call);
      }};
  return program;
}

}  // namespace gonio::tools::relief
