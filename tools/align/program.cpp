// align: poses of objects, places of lamps and sizes from rims and shadows' rims (lib/alignment).
#include "cli/program.h"

#include "alignment/alignment_document.h"
#include "base/error.h"
#include "tools/align/options.h"

namespace gonio::tools::align {
namespace {

void check(cli::Invocation& call) {
  if (!call.has_document)
    throw Error(Exit::usage, "manifest", "is missing", "-i scene.json: meshes, cameras and outlines with masks");
  if (call.text("masks") != "given" && call.out.empty())
    throw Error(Exit::usage, "--out", "is missing", "say where masks go that are found: --out aligned");
  alignment::check_alignment(call.document, request_of(call));
}

Exit run(cli::Invocation& call) {
  switch (alignment::align_document(call.document, request_of(call))) {
    case alignment::Verdict::found: return Exit::done;
    case alignment::Verdict::ambiguous: return Exit::quality;
    default: return Exit::negative;
  }
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "align",
      .sentence = "finds where objects and lamps are, and how large objects are, from rims in photographs",
      .synopsis = {"[OPTION]... [-i scene.json]", "--from nothing --free scale --out DIR [OPTION]... [-i scene.json]"},
      .options = options(),
      .takes_out = true,
      .sections_read = {"files", "cameras", "images", "meshes", "objects", "surfaces", "lights", "mechanisms",
                        "outlines"},
      .sections_written = {"files", "cameras", "images", "objects", "lights", "mechanisms", "outlines", "alignments",
                           "light_positions"},
      .files =
          {{"IMAGE-OBJECT-KIND-mask.exr", "with --masks: shares of pixels, and what nobody can tell"},
           {"IMAGE-OBJECT-KIND[-LIGHT].csv",
            "of each rim: its points, their offsets from the aligned model, and where on the mesh; LIGHT where the "
            "outline names one"}},
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
