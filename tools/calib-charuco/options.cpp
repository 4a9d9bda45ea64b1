// From the command line to a request.
#include "tools/calib-charuco/options.h"

#include <algorithm>

#include "base/error.h"
#include "base/quantity.h"
#include "cli/board_options.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "scan/projector_views.h"
#include "tools/calib-charuco/page.h"

namespace gonio::tools::calib_charuco {

using namespace gonio::camera;

namespace {

using cli::Type;

std::vector<std::string> names_of(const std::string& text) {
  std::vector<std::string> names(1);
  for (const char c : text) {
    if (c == ',')
      names.emplace_back();
    else
      names.back() += c;
  }
  return names;
}

std::vector<std::string> rig_of(const cli::Invocation& call) {
  const std::vector<std::string> names = names_of(call.text("rig"));
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (names[i] != names[j]) continue;
      throw Error(Exit::usage, "--rig", "names " + names[i] + " twice", "name every camera once");
    }
    if (names[i].empty()) throw Error(Exit::usage, "--rig", "has an empty name", "name the cameras: --rig left,right");
  }
  if (names.size() < 2) throw Error(Exit::usage, "--rig", "names one camera", "leave it out, or name two or more");
  return names;
}

std::vector<std::string> model_choices() {
  std::vector<std::string> names = calibrated_models();
  names.emplace_back("auto");
  return names;
}

}  // namespace

namespace {

// Cameras of another calibration, as they are known there; what its pages and maps were stays with it.
void enter_cameras(cli::Invocation& call, const std::string& path) {
  const manifest::Document other = manifest::read_document(path, {.allow_outside = true});
  if (other.cameras.empty()) throw Error(Exit::data, path, "has no cameras", "name what calib-charuco wrote");
  for (const auto& [name, camera] : other.cameras) {
    if (call.document.cameras.contains(name))
      throw Error(Exit::data, path, "has a camera " + name + " as the manifest has", "give --cameras or -i");
    manifest::Camera& entered = call.document.cameras[name] = camera;
    entered.quality.reset();
  }
  call.note_input(path);
}

}  // namespace

namespace {

scan::ProjectorRequest projector_of(const cli::Invocation& call) {
  const auto all = names_in(call.document, "projections");
  const std::string at = call.document.name + "#/projections";
  if (all.empty())
    throw Error(Exit::data, at, "has none", "structured-light --pattern writes what the projector shows");
  if (!call.given("projection") && all.size() > 1)
    throw Error(Exit::usage, "--projection", "is missing, and there are " + std::to_string(all.size()),
                "say which the projector showed: --projection " + all.front());
  const std::string name = call.given("projection") ? call.text("projection") : all.front();
  if (std::ranges::find(all, name) == all.end())
    throw Error(Exit::data, at, "has no " + name + " among " + std::to_string(all.size()),
                "--projection " + all.front());
  const std::string model = call.text("model") == "auto" ? "radial-tangential" : call.text("model");
  return {call.text("projector"), name, model};
}

void enter_projector(cli::Invocation& call) {
  const scan::ProjectorRequest request = projector_of(call);
  if (request.projector.empty()) throw Error(Exit::usage, "--projector", "has an empty name", "name it");
  if (call.given("IMAGE")) {
    call.document.allow_outside = true;
    std::vector<std::string> cameras{"camera"};
    if (call.given("rig")) cameras = rig_of(call);
    for (const std::string& name : cameras)
      if (const auto [entry, fresh] = call.document.cameras.try_emplace(name); fresh)
        entry->second.model = request.model;
    scan::enter_board_sequences(call.texts("IMAGE"), request, cameras, call.text("response"), call.document);
  }
  scan::enter_projector_views(request, call.document);
}

}  // namespace

CalibrationRequest request_of(cli::Invocation& call) {
  CalibrationRequest request;
  request.model = call.text("model");
  request.model_given = call.given("model") || !call.has_document;
  request.board_warp = call.flag("board-warp");
  for (const std::string& term : call.texts("fix")) request.fixed.insert(term);
  if (call.given("refine-window")) request.detection.window_px = static_cast<int>(call.integer("refine-window"));
  request.detection.parts = call.flag("parts");
  request.judge = !call.flag("no-quality");
  for (const std::string& text : call.texts("distance"))
    request.distances_m.push_back(parse_quantity(text, Dimension::length, "--distance"));
  for (const double d : request.distances_m)
    if (!(d > 0)) throw Error(Exit::usage, "--distance", "is not above zero", "give a distance from the camera: 0.5m");
  if (!call.out.empty()) {
    request.corners_csv = call.output_path("corners.csv");
    request.report = [&call](const CameraResult& camera, const Quality& quality, const std::string& suffix,
                             manifest::Document& document) {
      write_quality(
          camera, quality, [&call](const std::string& name) { return call.output_path(name); }, suffix, document);
    };
  }
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  if (call.given("projector")) scan::look_up_corners(projector_of(call), request, request.note_input);
  return request;
}

void enter_command_line(cli::Invocation& call) {
  if (!call.has_document) {
    call.document.name = "command line";
    if (!cli::describes_board(call)) {
      throw Error(Exit::usage, "calib-charuco", "has no board",
                  "add --checkerboard 9x6 --square 25mm, or a manifest with boards");
    }
    if (!call.given("IMAGE")) throw Error(Exit::usage, "IMAGE", "is missing", "name photographs of the board");
  }
  if (cli::describes_board(call)) cli::enter_described_board(call);
  if (call.given("cameras")) enter_cameras(call, call.text("cameras"));
  if (call.given("projector")) return enter_projector(call);
  // What the user names may lie anywhere.
  if (call.given("IMAGE") || call.given("dictionary-file")) call.document.allow_outside = true;
  if (!call.given("IMAGE")) {
    if (!call.given("rig")) return;
    throw Error(Exit::usage, "--rig", "has no pictures to look for names in",
                "name photographs, or give the images of the manifest a camera and a shot");
  }
  const std::string model = call.text("model") == "auto" ? "radial-tangential" : call.text("model");
  if (call.given("rig"))
    enter_rig(rig_of(call), call.texts("IMAGE"), model, call.document);
  else
    enter_pictures(call.texts("IMAGE"), model, call.document);
}

std::vector<cli::Option> calibration_options() {
  std::vector<cli::Option> list = cli::board_options();
  const std::vector<cli::Option> fitting = {
      {.name = "rig",
       .type = Type::text,
       .help = "Cameras held together, by words that the pictures' names contain; the rest of a name is the shot.",
       .metavar = "NAME,NAME"},
      {.name = "projector",
       .type = Type::text,
       .help = "Also calibrate the projector that lit the boards, under this name, as a camera of their rig.",
       .metavar = "NAME"},
      {.name = "projection",
       .type = Type::text,
       .help = "What it showed at every view, of several in the manifest.",
       .metavar = "NAME",
       .needs = {"projector"}},
      {.name = "response",
       .type = Type::choice,
       .help = "What the codes of photographs under a projection mean.",
       .preset = "linear",
       .choices = {"linear", "srgb"},
       .needs = {"projector"}},
      {.name = "model",
       .type = Type::choice,
       .help = "Lens model; a camera of the manifest keeps its own unless this is given. auto: by held-out views.",
       .preset = "radial-tangential",
       .choices = model_choices()},
      {.name = "cameras",
       .type = Type::input_file,
       .help = "Take the cameras from this manifest: calibrated on other pictures, to be held here (--fix intrinsics).",
       .metavar = "FILE"},
      {.name = "fix",
       .type = Type::choice,
       .help = "Hold a term: at the manifest's value, else at 0, equal focal lengths, the middle of the picture.",
       .choices = fixable_terms(),
       .repeat = true},
      {.name = "parts",
       .type = Type::flag,
       .help = "Also use parts of plain boards: for a lens, not for poses, which may be off by whole squares."},
      {.name = "board-warp", .type = Type::flag, .help = "Also fit how far the board sags (two parameters)."},
      {.name = "refine-window",
       .type = Type::integer,
       .help = "Half-window of corner refinement in pixels instead of the one that follows the squares.",
       .metavar = "N",
       .lower = 1,
       .upper = 50},
      {.name = "distance",
       .type = Type::quantity,
       .help = "Judge the prediction at this distance; may be repeated. Default: the boards' median, and twice that.",
       .dimension = Dimension::length,
       .lower = 1e-6,
       .upper = 1e6,
       .repeat = true},
      {.name = "no-quality",
       .type = Type::flag,
       .help = "Do not judge how well the camera predicts, nor compare halves of the views."}};
  list.insert(list.end(), fitting.begin(), fitting.end());
  return list;
}

}  // namespace gonio::tools::calib_charuco
