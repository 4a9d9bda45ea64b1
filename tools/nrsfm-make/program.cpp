// nrsfm-make: tracks of things that deform, from simulated animatronics or scans, as virtual cameras see them
// (lib/nrsfm/make/factorial.h).
#include "tools/nrsfm-make/call.h"

namespace gonio::tools::nrsfm_make {

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "nrsfm-make",
      .sentence = "make tracks of things that deform, with their truth",
      .synopsis = {"--out DIR [OPTION]... [-i FILE]", "--out DIR --meshes PATH --tracks PATH [OPTION]... [-i FILE]",
                   "--out DIR --object NAME --kind KIND [OPTION]... [-i FILE]",
                   "--out DIR --follow NAME [--truth FILE --object NAME] [OPTION]... [-i FILE]"},
      .options = options(),
      .takes_out = true,
      .takes_seed = true,
      .takes_resume = true,
      .sections_read = {"files", "images", "cameras", "meshes", "objects", "surfaces", "sequences"},
      .sections_written = {"files", "sequences", "meshes", "objects", "surfaces"},
      .files = {{"NAME.ply, NAME-0001.ply", "--object: its mesh with the paint, and its shapes"},
                {"OBJECT-NAME-pictures.mat",
                 "--follow: tracks out of photographs, with their standard deviations W_sigma; "
                 "beside the truth OBJECT-NAME-geometry.mat"},
                {"KIND-PATH-CAMERA-MISSING.mat", "a sequence: tracks W, visibility V, truth S, cameras R, T, K"}},
      .references = {"Jensen, Doest, Aanaes & Del Bue, A benchmark and evaluation of non-rigid structure from motion, "
                     "IJCV 129, 2021.",
                     "Grinspun, Hirani, Desbrun & Schroeder, Discrete shells, SCA 2003.",
                     "Bonet & Wood, Nonlinear continuum mechanics for finite element analysis, 2008."},
      .see_also = {"render(1)", "nrsfm-solve(1)", "explain(1)", "gonio-nrsfm(7)", "gonio-manifest(5)",
                   "gonio-conventions(7)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::nrsfm_make
