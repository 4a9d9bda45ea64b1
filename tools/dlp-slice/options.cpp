// See options.h.
#include "tools/dlp-slice/options.h"

#include <algorithm>

#include "base/assignment.h"
#include "base/error.h"
#include "base/quantity.h"
#include "cli/common_options.h"
#include "print/archive.h"

namespace gonio::tools::dlp_slice {
namespace {

using cli::Type;

cli::Option length(const char* name, const char* help, const char* preset = "") {
  return {.name = name,
          .type = Type::quantity,
          .help = help,
          .preset = preset,
          .dimension = Dimension::length,
          .lower = 0,
          .upper = 10};
}
cli::Option count(const char* name, const char* help, const char* preset, double lower, double upper) {
  return {.name = name, .type = Type::integer, .help = help, .preset = preset, .lower = lower, .upper = upper};
}
cli::Option flag(const char* name, const char* help) {
  return {.name = name, .type = Type::flag, .help = help};
}
cli::Option text(const char* name, const char* help, const char* metavar, bool repeat = false) {
  return {.name = name, .type = Type::text, .help = help, .metavar = metavar, .repeat = repeat};
}

void add_bodies(std::vector<cli::Option>& all) {
  all.push_back({.name = "printer",
                 .type = Type::input_file,
                 .help = "Manifest whose prints describes the printer. Default: the manifest that is read."});
  all.push_back(text("print", "Which of prints. Default: the only one.", "NAME"));
  all.push_back({.name = "unit",
                 .type = Type::choice,
                 .help = "Unit of the numbers of STL and OBJ files, which state none. PLY files are metres, 3MF files "
                         "say what they are.",
                 .choices = {"m", "mm", "um", "in"}});
  all.push_back({.name = "scale",
                 .type = Type::quantity,
                 .help = "Enlarge the meshes.",
                 .preset = "1",
                 .dimension = Dimension::ratio,
                 .lower = 1e-6,
                 .upper = 1e6});
  all.push_back(
      length("largest-hole", "Diagonal of the largest hole that is closed. Default: a twentieth of the mesh's."));
  all.push_back(text("at",
                     "Where the middle of a mesh's base stands on the platform; once for each mesh, in their "
                     "order. Default: in a row about the middle.",
                     "X,Y", true));
  all.push_back(text("turn", "Turn a mesh about z before; once for each mesh.", "ANGLE", true));
  all.push_back(length("gap", "Distance of meshes in a row.", "1mm"));
  all.push_back(length("layer", "Thickness of layers, instead of the printer's."));
  all.push_back(text("layers", "Layers that vary: from each height on layers of that thickness.", "HEIGHT:LENGTH,..."));
}

void add_structures(std::vector<cli::Option>& all) {
  all.push_back(text("structure",
                     "Micro-structure of faces that look towards the projector, MODEL:NAME=VALUE,...; with on=MESH for "
                     "one part, label=N for faces of one label.",
                     "SPEC", true));
  all.push_back(text("code",
                     "Text of a data matrix whose solid cells turn a structure's axes by a right angle: "
                     "file=code in --structure.",
                     "TEXT"));
  all.push_back({.name = "axes",
                 .type = Type::choice,
                 .help = "What a structure's u and v are: the platform's x and y, the mesh's texture coordinates, axes "
                         "of each face, or along each face the part of --direction that lies in it.",
                 .preset = "platform",
                 .choices = {"platform", "texture", "faces", "direction"}});
  all.push_back(text("direction", "--axes direction: where u points to, on the platform.", "X,Y,Z"));
  all.push_back(length("texture-length", "--axes texture: length of 1 of the texture coordinates.", "1mm"));
  all.push_back(flag("beneath", "Structures on faces that look away from the projector, too."));
  all.push_back(count("samples", "Places of a structure over a pixel, along each axis.", "4", 1, 64));
  all.push_back({.name = "coverage",
                 .type = Type::choice,
                 .help = "How the share of a voxel is found: by clipping, or by jittered rays.",
                 .preset = "exact",
                 .choices = {"exact", "rays"}});
  all.push_back(count("rays", "--coverage rays: rays through a pixel.", "16", 1, 4096));
}

void add_output(std::vector<cli::Option>& all) {
  std::string formats;
  for (const print::ArchiveFormat* format : print::all_archive_formats())
    formats += (formats.empty() ? "" : ", ") + std::string(format->name);
  all.push_back(
      {.name = "to",
       .type = Type::output_file,
       .help =
           "Layers to write. Default: layers.sl1s below --out, or layers.zip where the printer states no exposure."});
  all.push_back(text("format", ("Its format, where the name does not say it: " + formats + ".").c_str(), "NAME"));
  all.push_back({.name = "mirror",
                 .type = Type::choice,
                 .help = "Mirror pictures for the display.",
                 .preset = "none",
                 .choices = {"none", "x", "y", "xy"}});
  all.push_back(flag("compensate", "Choose grey values so that spread light and overcure are made up for."));
  all.push_back(count("iterations", "--compensate: steps of the search.", "60", 1, 100000));
  all.push_back(flag("predict", "Predict the printed surface: a relief and a mesh."));
  all.push_back({.name = "sent", .type = Type::input_file, .help = "Predict what these layers print."});
  all.push_back(text("window", "--predict: the part of the platform that is looked at. Default: all that is printed.",
                     "X,Y,WIDTH,HEIGHT"));
  all.push_back(count("points", "--predict: points of a pixel, along each axis.", "1", 1, 32));
  all.push_back(text("ground",
                     "--predict: what the printer adds: none, published, or a name in ground_noises. Default: "
                     "the print's.",
                     "NAME"));
}

void add_sample(std::vector<cli::Option>& all) {
  all.push_back(flag("calibration-sample", "Write the calibration sample's layers."));
  all.push_back(count("slab-layers", "White layers beneath the sample.", "20", 1, 10000));
  all.push_back(count("greys", "Grey values of a gradient of the sample.", "32", 5, 256));
  all.push_back(
      count("repetitions", "Repetitions of gradients and checkers; fewer where they do not fit.", "36", 4, 36));
  all.push_back({.name = "growth-from",
                 .type = Type::input_file,
                 .help = "Fit the growth of voxels to a height map of the printed sample.",
                 .metavar = "MAP",
                 .repeat = true});
  all.push_back(
      text("map-at", "Where the map's first point (top left) lies on the platform; once for each map.", "X,Y", true));
  all.push_back(text("map-turn", "By how much the map is turned; once for each map.", "ANGLE", true));
  all.push_back({.name = "search",
                 .type = Type::quantity,
                 .help = "How far about it the sample is looked for.",
                 .preset = "20px",
                 .dimension = Dimension::pixel,
                 .lower = 0,
                 .upper = 400});
  all.push_back(length("map-step", "Distance of a map's points, where it does not state one."));
  all.push_back(text(
      "wish", "Find the micro-structure whose printed surface has this figure: sq, sa, alpha, anisotropy, contrast.",
      "FIGURE=VALUE"));
  all.push_back({.name = "incidence",
                 .type = Type::quantity,
                 .help = "--wish contrast: of the light, from the normal.",
                 .preset = "30deg",
                 .dimension = Dimension::angle,
                 .lower = 0,
                 .upper = 1.5});
  all.push_back({.name = "view",
                 .type = Type::quantity,
                 .help = "--wish contrast: of the eye, from the normal.",
                 .preset = "0deg",
                 .dimension = Dimension::angle,
                 .lower = 0,
                 .upper = 1.5});
}

}  // namespace

std::vector<cli::Option> options() {
  std::vector<cli::Option> all;
  add_bodies(all), add_structures(all), add_output(all), add_sample(all);
  all.push_back(cli::report_option());
  return all;
}

Action action_of(const cli::Invocation& call) {
  if (call.flag("calibration-sample")) return Action::sample;
  if (call.given("growth-from")) return Action::growth;
  if (call.given("wish")) return Action::wish;
  if (call.given("sent")) return Action::predict;
  return Action::slice;
}

void check_options(const cli::Invocation& call, Action action) {
  const bool meshes = !call.texts("MESH").empty();
  const auto refuse = [](const std::string& option, const char* why, const char* remedy) {
    throw Error(Exit::usage, option, why, remedy);
  };
  if (action == Action::slice && !meshes)
    refuse("MESH", "is missing", "name a mesh: dlp-slice part.stl --unit mm --printer p.json");
  if (action != Action::slice && meshes)
    refuse(call.texts("MESH").front(), "is not sliced beside this option", "leave it out");
  if (call.out.empty() && action != Action::growth)
    refuse("--out", "is missing: files need a folder", "give --out DIR");
  const auto only = [&](const char* option, std::initializer_list<Action> of) {
    if (call.given(option) && std::ranges::find(of, action) == of.end())
      refuse(std::string("--") + option, "does nothing in this call", "leave it out");
  };
  only("structure", {Action::slice, Action::wish});
  for (const char* option : {"unit", "scale", "largest-hole", "at", "turn", "gap", "code", "axes", "direction",
                             "texture-length", "beneath", "coverage", "rays", "compensate", "iterations"})
    only(option, {Action::slice});
  only("samples", {Action::slice, Action::wish});
  for (const char* option : {"predict"}) only(option, {Action::slice, Action::sample});
  for (const char* option : {"window", "points"})
    only(option, {Action::slice, Action::sample, Action::predict, Action::wish});
  for (const char* option : {"map-at", "map-turn", "search", "map-step"}) only(option, {Action::growth});
  if (call.given("window") && action != Action::predict && !call.flag("predict") && action != Action::wish)
    refuse("--window", "is of --predict", "add --predict");
}

Vec3 direction_of(const cli::Invocation& call) {
  const std::string place = "--direction";
  if (call.text("axes") != "direction") {
    if (call.given("direction")) throw Error(Exit::usage, place, "does nothing without --axes direction", "give both");
    return {0, 0, 1};
  }
  std::vector<double> all;
  for (const std::string& piece : pieces(call.text("direction"), ','))
    all.push_back(parse_quantity(piece, Dimension::none, place));
  if (all.size() != 3 || !(norm(Vec3{all[0], all[1], all[2]}) > 0))
    throw Error(Exit::usage, place, "\"" + call.text("direction") + "\" is no direction", "type, say, 0,0,1");
  return {all[0], all[1], all[2]};
}

std::vector<double> lengths_of(const std::string& text, std::size_t count, const std::string& place) {
  std::vector<double> all;
  for (const std::string& piece : pieces(text, ',')) all.push_back(parse_quantity(piece, Dimension::length, place));
  if (all.size() != count)
    throw Error(Exit::usage, place, "\"" + text + "\" is not " + std::to_string(count) + " lengths",
                "type, say, 1mm,2mm");
  return all;
}

std::vector<LayerStep> layer_steps(const std::string& text, const std::string& place) {
  std::vector<LayerStep> steps;
  for (const std::string& piece : pieces(text, ',')) {
    const std::vector<std::string> two = pieces(piece, ':');
    if (two.size() != 2)
      throw Error(Exit::usage, place, "\"" + piece + "\" is no step", "type, say, 0mm:18um,1mm:10um");
    steps.push_back(
        {parse_quantity(two[0], Dimension::length, place), parse_quantity(two[1], Dimension::length, place)});
    const LayerStep& last = steps.back();
    if (!(last.layer_m > 0)) throw Error(Exit::usage, place, "\"" + piece + "\" has no thickness", "give one above 0");
    if (steps.size() > 1 ? !(last.from_m > steps[steps.size() - 2].from_m) : last.from_m != 0)
      throw Error(Exit::usage, place, "\"" + piece + "\" does not follow", "begin at 0mm and rise");
  }
  return steps;
}

}  // namespace gonio::tools::dlp_slice
