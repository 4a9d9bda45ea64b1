// nrsfm-solve: shapes from tracks of things that deform (lib/nrsfm/solve/solver.h).
#include "tools/nrsfm-solve/call.h"

namespace gonio::tools::nrsfm_solve {

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "nrsfm-solve",
      .sentence = "shapes of things that deform, from points that are followed through pictures",
      .synopsis = {"--solver NAME --out DIR [OPTION]... TRACKS...",
                   "--solver NAME --out DIR [OPTION]... [manifest.json]", "--list"},
      .options = options(),
      .operands =
          {{.name = "TRACKS", .type = cli::Type::input_file, .help = "Sequences: .mat or .npz files.", .repeat = true}},
      .standalone = {"list"},
      .takes_out = true,
      .takes_seed = true,
      .takes_resume = true,
      .sections_read = {"cameras", "files", "sequences"},
      .sections_written = {"files", "reconstructions", "sequences"},
      .files = {{"SEQUENCE-SOLVER.mat", "the reconstruction: S (3F x P), R (2F x 3), in the tracks' unit"}},
      .exits = {{Exit::quality, "some solvers failed on sequences that they take; the other answers are written"}},
      .references = {"Jensen, Doest, Aanaes & Del Bue, A benchmark and evaluation of non-rigid structure from motion, "
                     "IJCV 129, 2021.",
                     "Akhter, Sheikh, Khan & Kanade, Trajectory space: a dual representation for nonrigid structure "
                     "from motion, PAMI 33, 2011.",
                     "Gotardo & Martinez, Computing smooth time-trajectories for camera and deformable shape in "
                     "structure from motion with occlusion, PAMI 33, 2011."},
      .see_also = {"nrsfm-make(1)", "nrsfm-eval(1)", "gonio-nrsfm(7)", "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::nrsfm_solve
