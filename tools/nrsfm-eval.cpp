// nrsfm-eval: reconstructions of shapes that deform against the truth (lib/nrsfm/evaluate.h).
#include "nrsfm/eval_call.h"

namespace gonio::tools::nrsfm_eval {

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "nrsfm-eval",
      .sentence = "how far reconstructions of shapes that deform lie from the truth",
      .synopsis = {"--truth SEQUENCE [OPTION]... RECONSTRUCTION...", "[OPTION]... [manifest.json]"},
      .options = nrsfm::eval_options(),
      .operands = {{.name = "RECONSTRUCTION",
                    .type = cli::Type::input_file,
                    .help = "Shapes of every frame: .mat, .npz, or a folder of PLY files, one per frame.",
                    .repeat = true}},
      .standalone = {"truth"},
      .takes_seed = true,
      .sections_read = {"cameras", "files", "reconstructions", "sequences"},
      .sections_written = {"evaluations"},
      .references = {"Jensen, Doest, Aanaes & Del Bue, A benchmark and evaluation of non-rigid structure from motion, "
                     "IJCV 129, 2021.",
                     "Akhter, Sheikh, Khan & Kanade, Nonrigid structure from motion in trajectory space, NIPS 2008.",
                     "Dai, Li & He, A simple prior-free method for non-rigid structure-from-motion factorization, CVPR "
                     "2012.",
                     "Umeyama, Least-squares estimation of transformation parameters between two point patterns, PAMI "
                     "13, 1991.",
                     "Kuensch, The jackknife and the bootstrap for general stationary observations, Ann. Stat. 17, "
                     "1989."},
      .see_also = {"nrsfm-make(1)", "nrsfm-solve(1)", "gonio-manifest(5)"},
      .check = nrsfm::check_eval,
      .run = nrsfm::run_eval};
  return program;
}

}  // namespace gonio::tools::nrsfm_eval
