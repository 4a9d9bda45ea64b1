// vdi2634: how well a 3D scanner measures, from spheres and planes that it scanned (metrology/figures.h).
#include "cli/program.h"

#include "base/error.h"
#include "base/quantity.h"
#include "metrology/acceptance_document.h"

namespace gonio::tools::vdi2634 {
namespace {

using cli::Type;

const std::vector<std::string>& quantities() {
  static const std::vector<std::string> names{"probing-form", "probing-size", "sphere-distance", "flatness"};
  return names;
}

// "probing-form=0.05mm"
std::pair<std::string, double> limit_of(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  for (const std::string& known : quantities())
    if (name == known && equals != std::string::npos)
      return {name, parse_quantity(text.substr(equals + 1), Dimension::length, "--limit")};
  throw Error(Exit::usage, "--limit", "\"" + text + "\" is no limit",
              "write probing-form=0.05mm; there are probing-form, probing-size, sphere-distance, flatness");
}

metrology::AcceptanceRequest request_of(cli::Invocation& call) {
  metrology::AcceptanceRequest request;
  for (const std::string& cloud : call.texts("CLOUD")) request.clouds.emplace_back(cloud);
  request.metres_per_unit = call.text("unit") == "mm" ? 1e-3 : 1;
  request.planes = call.text("shape") == "plane";
  for (const std::string& region : call.texts("region")) request.regions.push_back(metrology::region_of(region));
  if (call.given("radius")) request.radius_m = call.number("radius");
  if (call.given("distance")) request.distance_m = call.number("distance");
  request.hold_radius = call.flag("hold-radius");
  for (const std::string& limit : call.texts("limit")) request.limits_m.insert(limit_of(limit));
  request.seed = call.seed;
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

Exit run(cli::Invocation& call) {
  call.document.allow_outside = true;  // what the user names may lie anywhere
  return metrology::measure_acceptance(call.document, request_of(call));
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "vdi2634",
      .sentence = "figures of a 3D scanner after VDI/VDE 2634 part 2, from point clouds",
      .synopsis = {"[--radius LENGTH] [--distance LENGTH] [OPTION]... CLOUD...", "--shape plane [OPTION]... CLOUD..."},
      .options = {{.name = "shape",
                   .type = Type::choice,
                   .help = "What the clouds show.",
                   .preset = "sphere",
                   .choices = {"sphere", "plane"}},
                  {.name = "unit",
                   .type = Type::choice,
                   .help = "What the coordinates in the PLY files count.",
                   .preset = "m",
                   .choices = {"m", "mm"}},
                  {.name = "radius",
                   .type = Type::quantity,
                   .help = "Calibrated radius of the spheres.",
                   .dimension = Dimension::length,
                   .lower = 1e-6,
                   .upper = 100},
                  {.name = "hold-radius",
                   .type = Type::flag,
                   .help = "Fit spheres of the calibrated radius, where too little of them is seen for a free one.",
                   .needs = {"radius"}},
                  {.name = "distance",
                   .type = Type::quantity,
                   .help = "Calibrated distance of two spheres' centres: in two regions of each cloud, or in clouds "
                           "named in pairs.",
                   .dimension = Dimension::length,
                   .lower = 1e-6,
                   .upper = 1000},
                  {.name = "region",
                   .type = Type::text,
                   .help = "Points within R of X, Y, Z are one sphere; give it once for every sphere of a cloud.",
                   .metavar = "X,Y,Z,R",
                   .repeat = true},
                  {.name = "limit",
                   .type = Type::text,
                   .help = "Exit 1 where a figure is larger: probing-form=0.05mm; may be repeated.",
                   .metavar = "FIGURE=LENGTH",
                   .repeat = true}},
      .operands =
          {{.name = "CLOUD", .type = Type::input_file, .help = "PLY files, with or without faces.", .repeat = true}},
      .takes_seed = true,
      .sections_read = {"files"},
      .sections_written = {"acceptance", "files"},
      .exits = {{Exit::negative, "a figure exceeds its limit"}},
      .references =
          {"VDI/VDE 2634 part 2, Optical 3-D measuring systems: optical systems based on area scanning, 2012.",
           "Coope, Circle fitting by linear and nonlinear least squares, JOTA 76(2), 1993.",
           "Liang & Zeger, Longitudinal data analysis using generalized linear models, Biometrika 73(1), 1986."},
      .see_also = {"gonio-manifest(5)", "gonio(7)"},
      .check = [](cli::Invocation& call) { metrology::check_acceptance(request_of(call)); },
      .run = run};
  return program;
}

}  // namespace gonio::tools::vdi2634
