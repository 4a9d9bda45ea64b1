// cloud-register: do views agree within what their points state, and moved to each other where that is asked for
// (lib/mesh/register).
#include "cli/program.h"

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "cli/viewpoints.h"
#include "mesh/register/register_document.h"

namespace gonio::tools::cloud_register {
namespace {

using cli::Type;

mesh::CloudRegisterRequest request_of(cli::Invocation& call) {
  mesh::CloudRegisterRequest request;
  request.clouds = call.texts("view");
  request.viewpoints_m = cli::viewpoints_m(call);
  if (call.given("fixed")) request.fixed = call.text("fixed");
  request.wish.refine = call.flag("refine");
  request.wish.hold = call.flag("hold");
  request.wish.limit_m = call.number("motion-limit");
  if (call.given("reach")) request.wish.reach_m = call.number("reach");
  request.wish.most = call.number("limit");
  request.wish.samples = static_cast<std::size_t>(call.integer("samples"));
  request.wish.seed = call.seed;
  if (call.given("html")) request.page = call.text("html");
  request.output_path = [&call](const std::string& name) { return call.output_path(name); };
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

void check(cli::Invocation& call) {
  if (!call.has_document)
    throw Error(Exit::usage, "manifest", "is missing", "-i scan.json: what structured-light wrote");
  if (call.flag("refine") && call.out.empty())
    throw Error(Exit::usage, "--out", "is missing", "say where clouds go that are moved: --out refined");
  mesh::check_cloud_register(call.document, request_of(call));
}

Exit run(cli::Invocation& call) {
  const mesh::CloudRegisterSummary found = mesh::cloud_register_document(call.document, request_of(call));
  if (found.pairs == 0) {
    log(LogLevel::warning, "no two views overlap: their surfaces are farther apart than --reach, or face apart");
    return Exit::negative;
  }
  if (found.refused) return Exit::quality;
  const double limit = call.number("limit");
  if (found.consistency <= limit) return Exit::done;
  log(LogLevel::warning, format("views lie apart by %.3g times what is stated (limit %.3g)", found.consistency, limit));
  return Exit::quality;
}

std::vector<cli::Option> options() {
  return {
      {.name = "view",
       .type = Type::text,
       .help = "Cloud to take; may be repeated. Left out: all.",
       .metavar = "NAME",
       .repeat = true},
      cli::viewpoint_option(),
      {.name = "refine",
       .help = "Find motions of all views but one under which their overlaps agree, and move them. Left out: "
               "nothing moves."},
      {.name = "fixed",
       .type = Type::text,
       .help = "The view that stays. Left out: the first.",
       .metavar = "NAME",
       .needs = {"refine"}},
      {.name = "hold",
       .help = "Move in the directions that overlaps hold where they do not hold all; the others stay as stated.",
       .needs = {"refine"}},
      {.name = "motion-limit",
       .type = Type::quantity,
       .help = "A direction is held where the overlaps tell motions of points along it to this, one standard "
               "deviation.",
       .preset = "0.1mm",
       .dimension = Dimension::length,
       .lower = 1e-9,
       .upper = 1},
      {.name = "reach",
       .type = Type::quantity,
       .help = "Farther than this apart, a point and a surface are not taken for the same place. Left out: eight "
               "times the points' distances and six of their standard deviations.",
       .dimension = Dimension::length,
       .lower = 1e-9,
       .upper = 10},
      {.name = "samples",
       .type = Type::integer,
       .help = "Points of each view that are compared with the others' surfaces.",
       .preset = "6000",
       .lower = 100,
       .upper = 1e7},
      {.name = "limit",
       .type = Type::number,
       .help = "Exit 2 where views lie apart by more than this many times what is stated; and nothing is moved where "
               "half of their points still would.",
       .preset = "2",
       .lower = 0.1,
       .upper = 1e6},
      {.name = "html", .type = Type::output_file, .help = "Write a report page here."}};
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "cloud-register",
      .sentence = "says whether measured views agree within their uncertainty, and moves them to each other on request",
      .synopsis = {"[OPTION]... [-i scan.json]", "--refine --out DIR [OPTION]... [-i scan.json]"},
      .options = options(),
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"files", "cameras", "rigs", "images", "clouds"},
      .sections_written = {"files", "images", "clouds", "registration"},
      .files = {{"NAME.ply",
                 "with --refine, of each view that moves: its cloud, points moved, covariances turned along"}},
      .exits = {{Exit::negative, "no two views overlap"},
                {Exit::quality,
                 "with --refine, nothing was moved: overlaps do not hold it, or it did not settle; or "
                 "views lie apart by more than --limit times what is stated"}},
      .references = {"Chen & Medioni, Object modelling by registration of multiple range images, Image and Vision "
                     "Computing 10(3), 1992.",
                     "Segal, Haehnel & Thrun, Generalized-ICP, Robotics: Science and Systems, 2009.",
                     "Gelfand, Ikemoto, Rusinkiewicz & Levoy, Geometrically stable sampling for the ICP algorithm, "
                     "3DIM 2003.",
                     "Liang & Zeger, Longitudinal data analysis using generalized linear models, Biometrika 73, 1986."},
      .see_also = {"structured-light(1)", "handeye(1)", "cloud-mesh(1)", "gonio-conventions(7)", "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::cloud_register
