// nrsfm-eval: reconstructions of shapes that deform against the truth (lib/nrsfm/evaluate/evaluate.h).
#include "tools/nrsfm-eval/call.h"

namespace gonio::tools::nrsfm_eval {

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "nrsfm-eval",
      .sentence = "how far reconstructions of shapes that deform lie from the truth",
      .synopsis = {"[OPTION]... [manifest.json]", "--truth SEQUENCE [OPTION]... RECONSTRUCTION...",
                   "--table FILE [OPTION]..."},
      .options = options(),
      .operands = {{.name = "RECONSTRUCTION",
                    .type = cli::Type::input_file,
                    .help = "Shapes of every frame: .mat, .npz, or a folder of PLY files, one per frame.",
                    .repeat = true}},
      .standalone = {"truth", "table"},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"cameras", "evaluations", "files", "reconstructions", "sequences"},
      .sections_written = {"evaluations"},
      .files = {{"anova.csv", "analysis: sums of squares, F and p of every term"},
                {"means.csv", "analysis: expected errors of levels and of pairs of levels"},
                {"ranks.csv", "analysis: ranks of algorithms with their intervals"},
                {"empty-cells.csv", "analysis: combinations without a result"},
                {"tables.tex", "analysis: all tables, for LaTeX (booktabs)"}},
      .references = {"Jensen, Doest, Aanaes & Del Bue, A benchmark and evaluation of non-rigid structure from motion, "
                     "IJCV 129, 2021.",
                     "Akhter, Sheikh, Khan & Kanade, Nonrigid structure from motion in trajectory space, NIPS 2008.",
                     "Dai, Li & He, A simple prior-free method for non-rigid structure-from-motion factorization, CVPR "
                     "2012.",
                     "Umeyama, Least-squares estimation of transformation parameters between two point patterns, PAMI "
                     "13, 1991.",
                     "Searle, Linear models for unbalanced data, Wiley 1987.",
                     "Mogstad, Romano, Shaikh & Wilhelm, Inference for ranks with applications to mobility across "
                     "neighbourhoods and academic achievement across countries, Rev. Econ. Stud. 91, 2024.",
                     "Kuensch, The jackknife and the bootstrap for general stationary observations, Ann. Stat. 17, "
                     "1989."},
      .see_also = {"nrsfm-make(1)", "nrsfm-solve(1)", "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::nrsfm_eval
