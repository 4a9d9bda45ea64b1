// explain: from a mismatch between recordings and simulation to the physics that was left out
// (explain/explain_document.h).
#include "cli/program.h"

#include <iostream>

#include "cli/height_maps.h"
#include "explain/domain_listing.h"
#include "explain/domains.h"
#include "explain/explain_document.h"
#include "tools/explain/operand.h"

namespace gonio::tools::explain {
namespace {

using cli::Type;

gonio::explain::ExplainRequest request_of(cli::Invocation& call) {
  gonio::explain::ExplainRequest request;
  request.options.smallest_effect = call.number("smallest-effect");
  request.options.sure = call.number("sure");
  request.options.level = call.number("level");
  request.options.hypotheses = call.texts("hypotheses");
  request.options.protect = call.texts("protect");
  request.options.negative_controls = static_cast<std::size_t>(call.integer("negative-controls"));
  request.options.seed = call.seed;
  request.options.budget_s = request.recordings.budget_s = call.given("budget") ? call.number("budget") : 0;
  for (const std::string& path : call.texts("repeat")) request.recordings.repeats.emplace_back(path);
  request.resample = static_cast<std::size_t>(call.integer("resample"));
  request.out = call.out;
  if (call.given("html"))
    request.page = call.text("html");
  else if (!call.out.empty())
    request.page = call.output_path("report.html");
  return request;
}

void check(cli::Invocation& call) {
  if (call.flag("list")) return;
  if (call.flag("domains")) throw Error(Exit::usage, "--domains", "says what --list prints", "give both");
  check_out(call);
  gonio::explain::check_hypotheses(call.texts("hypotheses"));
  read_operand(call);
  if (!call.has_document)
    throw Error(Exit::no_input, "explain", "has no manifest to read",
                "pipe one in, or name it: explain recording.json; or a table: explain data.csv --model ...");
  if (call.flag("check")) gonio::explain::problems_of(call.document, request_of(call).recordings);
}

Exit run(cli::Invocation& call) {
  if (call.flag("list")) {
    call.writes_document = false;
    std::cout << (call.flag("domains") ? gonio::explain::product_text() : gonio::explain::list_of_mechanisms())
              << std::flush;
    return Exit::done;
  }
  for (const std::filesystem::path& path : gonio::explain::files_of(call.document)) call.note_input(path);
  const gonio::explain::ExplainRequest request = request_of(call);
  for (const std::filesystem::path& path : request.recordings.repeats) call.note_input(path);
  return gonio::explain::explain_document(call.document, request);
}

std::vector<cli::Option> table_options() {
  return {
      {.name = "table",
       .type = Type::input_file,
       .help =
           "Explain this table, text in columns, JSON ({\"units\": {...}, \"rows\": [{...}, ...]}), .brdf or .binary."},
      {.name = "model",
       .type = Type::text,
       .help = "What predicts the table: sensor, light, volume, surface, tracks, or an expression over columns.",
       .metavar = "MODEL"},
      {.name = "observed",
       .type = Type::text,
       .help = "Column that was measured; may be repeated.",
       .metavar = "COLUMN",
       .repeat = true},
      {.name = "sigma",
       .type = Type::text,
       .help = "Column with one standard deviation of it; default: COLUMN_sigma, else repeats or neighbours.",
       .metavar = "COLUMN",
       .repeat = true},
      {.name = "group",
       .type = Type::text,
       .help = "Column whose equal values are held out together; default: series, else stretches of rows.",
       .metavar = "COLUMN"},
      {.name = "block",
       .type = Type::text,
       .help = "Column whose equal values share their noise; default: single rows.",
       .metavar = "COLUMN"},
      {.name = "units",
       .type = Type::text,
       .help = "Units that the headings do not state: theta=deg,f=1/sr.",
       .metavar = "NAME=UNIT,..."},
      {.name = "free",
       .type = Type::text,
       .help = "Parameters that are fitted, and where they start: a=1,b=0.",
       .metavar = "NAME=VALUE,..."}};
}

std::vector<cli::Option> engine_options() {
  return {
      {.name = "smallest-effect",
       .type = Type::quantity,
       .help = "Smallest effect of interest: images, rms share of the radiance; boards, share of the held-out error "
               "removed.",
       .preset = "1%",
       .dimension = Dimension::ratio,
       .lower = 0,
       .upper = 1,
       .aliases = {"matters"}},
      {.name = "sure",
       .type = Type::quantity,
       .help =
           "Probability that suffices to name one explanation alone, and that those which are listed have together.",
       .preset = "90%",
       .dimension = Dimension::ratio,
       .lower = 0.5,
       .upper = 0.9999},
      {.name = "level",
       .type = Type::number,
       .help = "False alarms allowed to the null test and to every name.",
       .preset = "0.01",
       .lower = 1e-6,
       .upper = 0.2},
      {.name = "hypotheses",
       .type = Type::text,
       .help = "Consider this mechanism only; may be repeated. Default: all that apply.",
       .metavar = "ID",
       .repeat = true},
      {.name = "protect",
       .type = Type::text,
       .help = "Keep this parameter, or all whose name begins with it and a slash, at the manifest's value: cameras/c.",
       .metavar = "NAME",
       .repeat = true},
      {.name = "negative-controls",
       .type = Type::integer,
       .help = "Mechanisms without physics that run in the same race.",
       .metavar = "N",
       .preset = "24",
       .lower = 0,
       .upper = 1000,
       .aliases = {"dummies"}},
      {.name = "resample",
       .type = Type::integer,
       .help = "Explain so many draws of three quarters of the recordings as well, and say how often the answer came "
               "out; it takes as many times longer.",
       .metavar = "N",
       .preset = "0",
       .lower = 0,
       .upper = 1000},
      {.name = "repeat",
       .type = Type::input_file,
       .help = "A further take of the same recordings, from which noise is measured; may be repeated.",
       .repeat = true},
      {.name = "budget",
       .type = Type::quantity,
       .help = "Time to spend, turned into an amount of work that is the same on every machine; default: no limit.",
       .metavar = "TIME",
       .dimension = Dimension::time,
       .lower = 0.001},
      {.name = "html",
       .type = Type::output_file,
       .help = "Write the report page here; with --out it is DIR/report.html."},
      {.name = "list",
       .type = Type::flag,
       .help = "Print the mechanisms with their conditions and confusions, and end."},
      {.name = "domains",
       .type = Type::flag,
       .help = "With --list: for each kind of recordings which mechanisms are asked, and why the others are not."}};
}

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = engine_options();
  for (cli::Option& option : table_options()) all.push_back(std::move(option));
  for (cli::Option& option : cli::picture_options()) all.push_back(std::move(option));
  return all;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "explain",
      .sentence = "find the physics that a simulation left out",
      .synopsis = {"[OPTION]... [-i FILE | recording.json]",
                   "[OPTION]... data.csv --model MODEL --observed COLUMN [--free NAME=VALUE,...]",
                   "[OPTION]... paint.brdf", "[OPTION]... map.tif --step LENGTH --unit LENGTH", "--list [--domains]"},
      .options = options(),
      .operands = {{.name = "FILE",
                    .type = Type::input_file,
                    .help =
                        "Recordings with their base model, a manifest that ends in .json; or a table; or a height map.",
                    .repeat = true}},
      .standalone = {"list", "table"},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"files", "boards", "cameras", "images", "meshes", "surfaces", "lights", "objects", "tables",
                        "mechanisms", "sequences", "reconstructions", "reliefs", "surface_fits"},
      .sections_written = {"boards", "cameras", "images", "surfaces", "lights", "tables", "files", "mechanisms",
                           "sequences", "reliefs", "explanations"},
      .files = {{"report.html", "one self-contained page: where, which curve, how sure, what to measure next"},
                {"effect-IMAGE.exr", "images and stacks: how far the named physics, or the mismatch, moves each pixel"},
                {"evidence-DOMAIN.csv",
                 "every observation with its prediction before and after, where there is a mismatch"}},
      .exits = {{Exit::done, "No mismatch that matters, or the physics that explains it is named."},
                {Exit::negative, "There is a mismatch that matters, and no physics in the library repairs it."},
                {Exit::quality,
                 "Written, but a fit did not converge or over a tenth of the observations were set aside."}},
      .references =
          {"M. Kennedy, A. O'Hagan, Bayesian calibration of computer models, JRSS B 63(3), 2001.",
           "P. Westfall, S. Young, Resampling-based multiple testing, Wiley, 1993.",
           "J. Hemerik, J. Goeman, L. Finos, Robust testing in generalized linear models by sign-flipping score "
           "contributions, JRSS B 82(3), 2020.",
           "K. Liang, S. Zeger, Longitudinal data analysis using generalized linear models, Biometrika 73(1), 1986."},
      .see_also = {"calib-charuco(1)", "render(1)", "compare(1)", "gonio-manifest(5)", "gonio-conventions(7)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::explain
