// acquire: plans views of an instrument, moves it, lights, photographs, and knows of every frame what it is
// (lib/acquisition).
#include "acquisition/desk/specimen_laboratory.h"
#include "acquisition/plan/shown_frames.h"
#include "acquisition/run/instrument.h"
#include "base/progress.h"
#include "cli/board_options.h"
#include "tools/acquire/call.h"

namespace gonio::tools::acquire {
namespace {

bool plans(const cli::Invocation& call) {
  return call.given("plan") || call.flag("next") || call.given("pairs");
}

// --picture needs no plan, --gltf does without where there is none.
bool draws_without_plan(const cli::Invocation& call) {
  if (plans(call) || call.flag("go") || call.flag("dry-run") || call.given("html") || call.given("plan-id"))
    return false;
  return call.given("gltf") ? call.document.plans.empty() : call.given("picture");
}

// With --check every device is asked how it is, and none moves.
void check(cli::Invocation& call) {
  if (call.given("specimen")) {
    if (call.out.empty()) throw Error(Exit::usage, "--specimen", "has no folder to write to", "give --out DIR");
    return;
  }
  acquisition::believed_laboratory(call.document);
  check_drawings(call);
  if (plans(call)) scene_of(call);
  if (call.given("show")) {
    if (!plans(call)) throw Error(Exit::usage, "--show", "needs a plan that is made now", "say which views: --plan");
    acquisition::shown_projection(call.text("show"), "--show", call.document);
  }
  if (call.flag("go") && call.out.empty())
    throw Error(Exit::usage, "--go", "has no folder for its frames", "give --out DIR");
  check_options_of(call);
  if (cli::describes_board(call)) cli::board_of(call);
  if (!call.flag("check")) return;
  bool all_well = true;
  for (const std::string& line : acquisition::inspect(call.document, &all_well)) log(LogLevel::info, line);
  if (!all_well) throw Error(Exit::unavailable, "laboratory", "not all of its devices answer");
}

Exit run(cli::Invocation& call) {
  if (call.given("specimen")) {
    call.document = acquisition::specimen_laboratory(call.text("specimen"), call.out);
    return Exit::done;
  }
  if (call.flag("serve")) return serve(call);
  const acquisition::Laboratory laboratory = acquisition::believed_laboratory(call.document);
  if (draws_without_plan(call)) {
    draw(call, laboratory, nullptr);
    return Exit::done;
  }
  const manifest::Plan& chosen = plans(call) ? plan(call, laboratory) : chosen_plan(call);
  if (call.flag("dry-run") || plans(call)) log(LogLevel::info, summary(chosen));
  draw(call, laboratory, &chosen);
  if (call.flag("go")) return go(call, laboratory, chosen);
  if (!plans(call) && !call.flag("dry-run") && !call.given("html") && !call.given("gltf"))
    throw Error(Exit::usage, "--go", "is not given, and nothing else is asked for",
                "plan (--plan), look (--dry-run, --html, --picture, --gltf), or let it move (--go)");
  return chosen.unreachable.empty() ? Exit::done : Exit::quality;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "acquire",
      .sentence = "plan views of an instrument, move it, light, photograph, and check every frame",
      .synopsis = {"--plan PATTERN [OPTION]... [-i FILE | lab.json]",
                   "--go --out DIR [OPTION]... [-i FILE | plan.json]", "--specimen NAME --out DIR",
                   "--serve [OPTION]... [-i FILE | lab.json]", "--dry-run [-i FILE | plan.json]",
                   "--check [-i FILE | lab.json]", "--picture FILE [-i FILE | lab.json]"},
      .options = options(),
      .operands = {{.name = "MANIFEST",
                    .type = cli::Type::text,
                    .help = "The laboratory's manifest, instead of -i.",
                    .metavar = "MANIFEST"}},
      .reads = cli::Reads::optional,
      .standalone = {"specimen"},
      .takes_out = true,
      .takes_seed = true,
      .takes_resume = true,
      .sections_read = {"files", "laboratory", "plans", "cameras", "lights", "objects", "surfaces", "mechanisms",
                        "explanations", "images", "boards", "mountings", "projections"},
      .sections_written = {"files", "laboratory", "plans", "runs", "images", "robots", "boards"},
      .files = {{"frames/IMAGE.png", "raw frames, the sensor's own numbers, 8 or 16 bit"},
                {"journal.jsonl", "what was intended and what came of it, a line each; what --resume goes by"}},
      .exits = {{Exit::quality,
                 "views are out of reach, frames were refused, or views of a board have moved beyond --drift-limit"}},
      .references = {"Elias & Wen, IK-Geo: Unified robot inverse kinematics using subproblem decomposition, 2025.",
                     "Kuffner & LaValle, RRT-Connect, ICRA 2000.",
                     "Universal Robots, Real-Time Data Exchange (RTDE) guide.", "AIA, GigE Vision 1.2.",
                     "EMVA, GenICam standard features naming convention 2.7."},
      .see_also = {"structured-light(1)", "calib-charuco(1)", "handeye(1)", "develop(1)", "render(1)", "explain(1)",
                   "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::acquire
