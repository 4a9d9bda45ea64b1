// explain: from a mismatch between recordings and simulation to the physics that was left out
// (explain/explain_document.h).
#include <iostream>

#include "cli/program.h"
#include "explain/domains.h"
#include "explain/explain_document.h"

namespace gonio::tools::explain {
namespace {

using cli::Type;

gonio::explain::ExplainRequest request_of(cli::Invocation& call) {
  gonio::explain::ExplainRequest request;
  request.options.matters = call.number("matters");
  request.options.level = call.number("level");
  request.options.hypotheses = call.texts("hypotheses");
  request.options.protect = call.texts("protect");
  request.options.dummies = static_cast<std::size_t>(call.integer("dummies"));
  request.options.seed = call.seed;
  request.out = call.out;
  if (call.given("html"))
    request.page = call.text("html");
  else if (!call.out.empty())
    request.page = call.output_path("report.html");
  return request;
}

void check(cli::Invocation& call) {
  if (call.flag("list")) return;
  gonio::explain::check_hypotheses(call.texts("hypotheses"));
  if (!call.has_document)
    throw Error(Exit::no_input, "explain", "has no manifest to read",
                "pipe one in, or name it: explain recording.json");
  if (call.flag("check")) gonio::explain::problems_of(call.document);
}

Exit run(cli::Invocation& call) {
  if (call.flag("list")) {
    call.writes_document = false;
    std::cout << gonio::explain::list_of_mechanisms() << std::flush;
    return Exit::done;
  }
  for (const std::filesystem::path& path : gonio::explain::files_of(call.document)) call.note_input(path);
  return gonio::explain::explain_document(call.document, request_of(call));
}

std::vector<cli::Option> options() {
  return {
      {.name = "matters",
       .type = Type::quantity,
       .help = "Smallest effect worth a name: images, rms share of the radiance; boards, share of the held-out error "
               "removed.",
       .preset = "1%",
       .dimension = Dimension::ratio,
       .lower = 0,
       .upper = 1},
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
      {.name = "dummies",
       .type = Type::integer,
       .help = "Mechanisms without physics that run in the same race.",
       .metavar = "N",
       .preset = "24",
       .lower = 0,
       .upper = 1000},
      {.name = "html",
       .type = Type::output_file,
       .help = "Write the report page here; with --out it is DIR/report.html."},
      {.name = "list",
       .type = Type::flag,
       .help = "Print the mechanisms with their conditions and confusions, and end."}};
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "explain",
      .sentence = "find the physics that a simulation left out",
      .synopsis = {"[OPTION]... [-i FILE | recording.json]", "--list"},
      .options = options(),
      .operands = {{.name = "MANIFEST",
                    .type = Type::input_file,
                    .help = "Recordings with their base model; ends in .json."}},
      .standalone = {"list"},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"files", "boards", "cameras", "images", "meshes", "surfaces", "lights", "objects", "tables",
                        "mechanisms"},
      .sections_written = {"boards", "cameras", "images", "surfaces", "lights", "mechanisms", "explanations"},
      .files = {{"report.html", "one self-contained page: where, which curve, how sure, what to measure next"},
                {"mask-*.png", "images: where the mismatch is"}},
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
