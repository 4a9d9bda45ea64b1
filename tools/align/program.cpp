// align: poses of objects, places of lamps and sizes from rims and shadows' rims (lib/alignment).
#include "cli/program.h"

#include "alignment/alignment_document.h"
#include "base/error.h"

namespace gonio::tools::align {
namespace {

using cli::Type;

alignment::AlignmentRequest request_of(cli::Invocation& call) {
  alignment::AlignmentRequest request;
  request.input.objects = call.texts("object");
  for (const std::string& what : call.texts("free")) request.input.freed.insert(what);
  for (const std::string& what : call.texts("hold")) request.input.held.insert(what);
  request.input.scale_sigma = call.number("scale-sigma");
  request.input.contact_m = call.flag("no-contact") ? 0 : call.number("contact");
  request.input.smooth_px = call.number("smooth");
  const std::string& from = call.text("from");
  using From = alignment::AlignWish::From;
  request.wish.from = from == "stated" ? From::stated : from == "nothing" ? From::nothing : From::either;
  request.input.any_start = request.wish.from != From::stated;
  request.wish.lamps_known = request.input.held.contains("light");
  request.wish.reach_px = call.number("reach");
  request.wish.least_share = call.number("least-share");
  request.wish.most_sigma_px = call.number("limit");
  request.wish.search.directions = static_cast<int>(call.integer("directions"));
  request.wish.search.move_station = request.input.freed.contains("camera") && request.input.held.contains("pose");
  if (call.given("html")) request.page = call.text("html");
  if (!call.out.empty()) request.output_path = [&call](const std::string& name) { return call.output_path(name); };
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

void check(cli::Invocation& call) {
  if (!call.has_document)
    throw Error(Exit::usage, "manifest", "is missing", "-i scene.json: meshes, cameras and outlines with masks");
  alignment::check_alignment(call.document, request_of(call));
}

Exit run(cli::Invocation& call) {
  switch (alignment::align_document(call.document, request_of(call))) {
    case alignment::Verdict::found: return Exit::done;
    case alignment::Verdict::ambiguous: return Exit::quality;
    default: return Exit::negative;
  }
}

std::vector<cli::Option> options() {
  return {
      {.name = "object",
       .type = Type::text,
       .help = "Object to align; may be repeated. Left out: all that outlines show.",
       .metavar = "ID",
       .repeat = true},
      {.name = "from",
       .type = Type::choice,
       .help =
           "Where to begin: at the stated pose, from nothing, or at the stated one and, where that leads nowhere, from "
           "nothing.",
       .preset = "either",
       .choices = {"stated", "nothing", "either"}},
      {.name = "free",
       .type = Type::choice,
       .help = "What else is not known, beside poses and lamps: the mesh's three scales, one size, the cameras' poses, "
               "their "
               "focal lengths, the ground. May be repeated.",
       .choices = {"scale", "size", "camera", "focal", "ground"},
       .repeat = true},
      {.name = "hold",
       .type = Type::choice,
       .help = "What is known exactly. May be repeated.",
       .choices = {"pose", "light"},
       .repeat = true},
      {.name = "scale-sigma",
       .type = Type::number,
       .help = "One standard deviation of scales about 1, before anything is seen.",
       .preset = "0.05",
       .lower = 1e-6,
       .upper = 1},
      {.name = "contact",
       .type = Type::quantity,
       .help = "One standard deviation of the lowest vertex's height over the ground.",
       .preset = "0.1mm",
       .dimension = Dimension::length,
       .lower = 1e-7,
       .upper = 1},
      {.name = "no-contact",
       .help = "The object hangs, or the ground is known badly: it need not touch.",
       .conflicts = {"contact"}},
      {.name = "reach",
       .type = Type::number,
       .help = "How far rims may be off at the stated pose, px.",
       .preset = "60",
       .lower = 4,
       .upper = 2000},
      {.name = "smooth",
       .type = Type::number,
       .help = "Gaussian that smooths the staircase of binary masks, px.",
       .preset = "1.2",
       .lower = 0.3,
       .upper = 10},
      {.name = "limit",
       .type = Type::number,
       .help = "Lost where points lie farther off the rims than this, one standard deviation, px.",
       .preset = "1.5",
       .lower = 0.05,
       .upper = 50},
      {.name = "least-share",
       .type = Type::number,
       .help = "Lost where less of the model's rims was seen than this, or less of what was seen is the model's.",
       .preset = "0.9",
       .lower = 0.1,
       .upper = 1},
      {.name = "directions",
       .type = Type::integer,
       .help = "From nothing: directions from which the object may be seen.",
       .preset = "400",
       .lower = 20,
       .upper = 100000},
      {.name = "html", .type = Type::output_file, .help = "Write a report page here."}};
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "align",
      .sentence = "finds where objects and lamps are, and how large objects are, from rims in photographs",
      .synopsis = {"[OPTION]... [-i scene.json]", "--from nothing --free scale --out DIR [OPTION]... [-i scene.json]"},
      .options = options(),
      .takes_out = true,
      .sections_read = {"files", "cameras", "images", "meshes", "objects", "lights", "outlines"},
      .sections_written = {"files", "cameras", "images", "objects", "lights", "mechanisms", "outlines", "alignments"},
      .files = {{"IMAGE-OBJECT-KIND.csv",
                 "of each rim: its points, their offsets from the aligned model, and where on the mesh"}},
      .exits = {{Exit::negative, "an object is lost, or only its mirror image fits; it stays where it was stated"},
                {Exit::quality, "several poses fit, or a direction is open"}},
      .references =
          {"Hannemose et al., Alignment of rendered images with photographs for testing appearance models, Applied "
           "Optics 59, 2020.",
           "Hu, Visual pattern recognition by moment invariants, IRE Trans. Information Theory 8, 1962.",
           "Blinn, Me and my (fake) shadow, IEEE Computer Graphics and Applications 8(1), 1988.",
           "Liang & Zeger, Longitudinal data analysis using generalized linear models, Biometrika 73, 1986."},
      .see_also = {"render(1)", "compare(1)", "explain(1)", "handeye(1)", "gonio-conventions(7)", "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::align
