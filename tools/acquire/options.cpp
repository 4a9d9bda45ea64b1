// The command line of acquire.
#include "acquisition/desk/served_laboratory.h"
#include "acquisition/desk/specimen_laboratory.h"
#include "acquisition/plan/view_pattern.h"
#include "base/assignment.h"
#include "base/quantity.h"
#include "cli/board_options.h"
#include "cli/common_options.h"
#include "manifest/sections/board.h"
#include "manifest/sections/laboratory.h"
#include "tools/acquire/call.h"

namespace gonio::tools::acquire {
namespace {

using cli::Type;

std::string pattern_names() {
  std::string names;
  for (const auto* pattern : acquisition::all_view_patterns()) names += (names.empty() ? "" : ", ") + pattern->name;
  return names;
}

std::vector<std::string> specimen_names() {
  std::vector<std::string> names;
  for (const auto& lab : acquisition::specimen_laboratories()) names.push_back(lab.name);
  return names;
}

std::string specimen_sentences() {
  std::string all;
  for (const auto& lab : acquisition::specimen_laboratories())
    all += (all.empty() ? "" : "; ") + lab.name + ": " + lab.sentence;
  return all + ".";
}

Vec3 vector_of(const std::string& text, Dimension dimension, const char* option) {
  const auto numbers = pieces(text, ',');
  if (numbers.size() != 3)
    throw Error(Exit::usage, option,
                "\"" + text + "\" has " + std::to_string(numbers.size()) + " numbers, 3 are needed",
                dimension == Dimension::length ? "give a point: 0m,0m,5cm" : "give a direction: 0,0,1");
  return {parse_quantity(numbers[0], dimension, option), parse_quantity(numbers[1], dimension, option),
          parse_quantity(numbers[2], dimension, option)};
}

const manifest::Laboratory& section_of(const cli::Invocation& call) {
  if (call.document.laboratory.entry.empty())
    throw Error(Exit::data, manifest::place(call.document, "/laboratory"), "is missing",
                "describe the instrument there (gonio-manifest(5))");
  return call.document.laboratory.entry.front();
}

template <class Members>
std::string names_of(const Members& members) {
  std::string names;
  for (const auto& [name, member] : members) names += (names.empty() ? "" : ", ") + name;
  return names.empty() ? "the laboratory has none" : "there is " + names;
}

std::vector<cli::Option> planning_options() {
  return {{.name = "plan",
           .type = Type::text,
           .help = "Plan a pattern of views: NAME or NAME:NUMBER=VALUE,...: " + pattern_names() + ".",
           .metavar = "PATTERN",
           .repeat = true},
          {.name = "next",
           .type = Type::flag,
           .help = "Plan the measurements that explain, calib-charuco or handeye would take next.",
           .conflicts = {"plan", "pairs"}},
          {.name = "pairs",
           .type = Type::input_file,
           .help = "Plan pairs of directions, as brdf-fit --plan lists them.",
           .conflicts = {"plan"}},
          {.name = "fresh",
           .type = Type::flag,
           .help = "Plan for another thing: images, tables and plans that are there are left out; lenses and mountings "
                   "stay.",
           .conflicts = {"next"}},
          {.name = "target",
           .type = Type::text,
           .help = "What is looked at, world.",
           .metavar = "X,Y,Z",
           .preset = "0m,0m,0m"},
          {.name = "up",
           .type = Type::text,
           .help = "The pole of hemispheres; a sample's normal.",
           .metavar = "X,Y,Z",
           .preset = "0,0,1"},
          {.name = "camera",
           .type = Type::text,
           .help = "Which camera, where the laboratory has several.",
           .metavar = "NAME"},
          {.name = "lamp",
           .type = Type::text,
           .help = "Which lamps are lit, the one that an arm moves first. Default: all.",
           .metavar = "NAME",
           .repeat = true},
          {.name = "exposure",
           .type = Type::quantity,
           .help = "Exposure; several make a bracket.",
           .preset = "10ms",
           .dimension = Dimension::time,
           .lower = 1e-7,
           .upper = 3600,
           .repeat = true},
          {.name = "show",
           .type = Type::text,
           .help = "At every view the screen shows this projection, and every frame of it is photographed.",
           .metavar = "[SCREEN=]PROJECTION"},
          {.name = "turntable",
           .type = Type::text,
           .help = "Which turntable turns, where the laboratory has several.",
           .metavar = "NAME"},
          {.name = "reference",
           .type = Type::text,
           .help = "Pattern of the views that --reference-every comes back to.",
           .metavar = "PATTERN",
           .needs = {"reference-every"}},
          {.name = "straight", .type = Type::flag, .help = "The camera follows straight lines, in the order as asked."},
          {.name = "keep-order",
           .type = Type::flag,
           .help = "Take the views as they are asked for.",
           .conflicts = {"shuffle"}},
          {.name = "shuffle",
           .type = Type::flag,
           .help = "Take them in a random order: tells drift from what is measured."},
          {.name = "repeats",
           .type = Type::quantity,
           .help = "Share of the views that are taken twice.",
           .preset = "0%",
           .dimension = Dimension::ratio,
           .lower = 0,
           .upper = 1},
          {.name = "reference-every",
           .type = Type::integer,
           .help = "Views between frames of the --reference.",
           .metavar = "N",
           .lower = 1},
          {.name = "dark-every",
           .type = Type::integer,
           .help = "Views between frames with the lamps off.",
           .metavar = "N",
           .lower = 1},
          {.name = "board-every",
           .type = Type::integer,
           .help = "Views between frames of the board, of --plan board: checks, where it is described.",
           .metavar = "N",
           .lower = 1},
          {.name = "board-target",
           .type = Type::text,
           .help = "What --plan board looks at, world, where the board lies elsewhere. Default: --target.",
           .metavar = "X,Y,Z"}};
}

std::vector<cli::Option> checking_options() {
  std::vector<cli::Option> list = cli::board_options();
  const std::vector<cli::Option> own = {
      {.name = "drift-limit",
       .type = Type::text,
       .help =
           "Check views: how far the board may have moved before the camera, 0.3mm, 0.1deg, or 0.5px in the picture.",
       .metavar = "LIMIT"},
      {.name = "on-drift",
       .type = Type::choice,
       .help =
           "Beyond it: stop where the arms stand (--resume takes the frames in question again), or mark the frames.",
       .preset = "stop",
       .choices = {"stop", "mark"},
       .needs = {"drift-limit"}},
      {.name = "measure-anew",
       .type = Type::flag,
       .help = "Forget what earlier runs of the plan measured: poses, and the views that checks are held against."}};
  list.insert(list.end(), own.begin(), own.end());
  return list;
}

std::vector<cli::Option> running_options() {
  return {{.name = "go",
           .type = Type::flag,
           .help = "Carry the plan out: arms move, lamps light. Nothing ever moves without it."},
          {.name = "dry-run",
           .type = Type::flag,
           .help = "Say what the plan would do, and how long it would take.",
           .conflicts = {"go"}},
          {.name = "plan-id",
           .type = Type::text,
           .help = "Which plan, where the manifest has several. Default: its last.",
           .metavar = "ID"},
          {.name = "wait",
           .type = Type::quantity,
           .help = "How long to wait for an instrument that another program drives.",
           .preset = "0s",
           .dimension = Dimension::time,
           .lower = 0},
          {.name = "retakes",
           .type = Type::integer,
           .help = "How often a frame that disagrees is taken again.",
           .preset = "4",
           .lower = 0,
           .upper = 100},
          {.name = "truth",
           .type = Type::input_file,
           .help = "sim:// devices, --serve: what is really so, a manifest with mechanisms that the description "
                   "leaves out."},
          {.name = "spp",
           .type = Type::integer,
           .help = "sim:// cameras, --serve: samples a pixel of their pictures.",
           .preset = "64",
           .lower = 1,
           .upper = 65536},
          {.name = "specimen",
           .type = Type::choice,
           .help = "Write a built-in laboratory, all of it simulated. " + specimen_sentences(),
           .choices = specimen_names()},
          cli::report_option()};
}

std::vector<cli::Option> drawing_options() {
  return {
      {.name = "picture",
       .type = Type::output_file,
       .help = "Draw the laboratory as it is described, its arms at home: one page that needs no network. No device "
               "is asked."},
      {.name = "gltf",
       .type = Type::output_file,
       .help = "Write the plan, or without one the laboratory, for other programs: glTF 2.0, animated; FILE.glb or "
               "FILE.gltf."}};
}

std::vector<cli::Option> serving_options() {
  return {
      {.name = "serve",
       .type = Type::flag,
       .help = "Serve the laboratory on loopback until interrupted: arms, lamps, turntables and cameras, simulated. "
               "Writes the description whose URLs reach them.",
       .conflicts = {"plan", "next", "pairs", "go", "dry-run", "html", "picture", "gltf", "specimen"}},
      {.name = "scene",
       .type = Type::input_file,
       .help = "--serve: what stands in the laboratory, a manifest with objects, surfaces, lights.",
       .needs = {"serve"}},
      {.name = "faults",
       .type = Type::text,
       .help = "--serve: what goes wrong and how often, NAME=PROBABILITY,...: " + acquisition::fault_list() + ".",
       .metavar = "FAULTS",
       .needs = {"serve"}},
      {.name = "pace",
       .type = Type::number,
       .help = "--serve: how many times faster than ours the laboratory's time runs.",
       .metavar = "N",
       .preset = "1",
       .lower = 0.01,
       .upper = 1000,
       .needs = {"serve"}},
      {.name = "port",
       .type = Type::integer,
       .help = "--serve: the first port, others follow it; 0 takes any that are free.",
       .metavar = "N",
       .preset = "0",
       .lower = 0,
       .upper = 65000,
       .needs = {"serve"}}};
}

}  // namespace

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = planning_options();
  for (cli::Option& option : serving_options()) all.push_back(std::move(option));
  for (cli::Option& option : checking_options()) all.push_back(std::move(option));
  for (cli::Option& option : running_options()) all.push_back(std::move(option));
  for (cli::Option& option : drawing_options()) all.push_back(std::move(option));
  return all;
}

acquisition::PatternScene board_scene_of(const cli::Invocation& call) {
  acquisition::PatternScene scene = scene_of(call);
  if (call.given("board-target"))
    scene.target_m = vector_of(call.text("board-target"), Dimension::length, "--board-target");
  return scene;
}

acquisition::PatternScene scene_of(const cli::Invocation& call) {
  const manifest::Laboratory& lab = section_of(call);
  acquisition::PatternScene scene;
  scene.target_m = vector_of(call.text("target"), Dimension::length, "--target");
  scene.up = normalized(vector_of(call.text("up"), Dimension::none, "--up"));
  scene.camera = call.given("camera")      ? call.text("camera")
                 : lab.cameras.size() == 1 ? lab.cameras.begin()->first
                                           : std::string();
  if (!lab.cameras.contains(scene.camera))
    throw Error(
        Exit::usage, "--camera",
        scene.camera.empty() ? "which camera is not said" : "\"" + scene.camera + "\" is none of the laboratory's",
        names_of(lab.cameras));
  if (call.given("lamp"))
    scene.lamps = call.texts("lamp");
  else
    for (const auto& [name, lamp] : lab.lamps) scene.lamps.push_back(name);
  for (const std::string& lamp : scene.lamps)
    if (!lab.lamps.contains(lamp))
      throw Error(Exit::usage, "--lamp", "\"" + lamp + "\" is none of the laboratory's", names_of(lab.lamps));
  scene.turntable = call.given("turntable")      ? call.text("turntable")
                    : lab.turntables.size() == 1 ? lab.turntables.begin()->first
                                                 : std::string();
  if (!scene.turntable.empty() && !lab.turntables.contains(scene.turntable))
    throw Error(Exit::usage, "--turntable", "\"" + scene.turntable + "\" is none of the laboratory's",
                names_of(lab.turntables));
  for (const std::string& exposure : call.texts("exposure"))
    scene.exposures_s.push_back(parse_quantity(exposure, Dimension::time, "--exposure"));
  return scene;
}

acquisition::PlanOptions plan_options_of(const cli::Invocation& call) {
  acquisition::PlanOptions options;
  options.seed = call.seed;
  options.keep_order = call.flag("keep-order");
  options.shuffle = call.flag("shuffle");
  options.repeat_share = call.number("repeats");
  const auto every = [&call](const char* name) { return call.given(name) ? static_cast<int>(call.integer(name)) : 0; };
  options.reference_every = every("reference-every");
  options.dark_every = every("dark-every");
  options.board_every = every("board-every");
  const acquisition::PatternScene scene = scene_of(call);
  options.target_m = scene.target_m;
  if (call.flag("straight")) options.straight = scene.camera;
  return options;
}

acquisition::CheckOptions check_options_of(const cli::Invocation& call) {
  acquisition::CheckOptions options;
  if (call.given("drift-limit"))
    options.limit = acquisition::parse_drift_limit(call.text("drift-limit"), "--drift-limit");
  options.on_drift = call.text("on-drift") == "mark" ? acquisition::OnDrift::mark : acquisition::OnDrift::stop;
  const auto& boards = call.document.boards;
  if (boards.size() == 1) options.board = boards.begin()->first;
  if (boards.size() > 1 && options.limit)
    throw Error(Exit::data, manifest::place(call.document, "/boards"),
                "describes " + std::to_string(boards.size()) + " boards", "leave the one that is checked");
  return options;
}

double wait_of(const cli::Invocation& call) {
  return call.number("wait");
}

}  // namespace gonio::tools::acquire
