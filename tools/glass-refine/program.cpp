// glass-refine: the shape of a transparent object from views before a polarized screen; physics corrects what a network
// said (lib/glass/refine/refine.h).
#include "tools/glass-refine/call.h"

namespace gonio::tools::glass_refine {

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "glass-refine",
      .sentence = "find the shape of a transparent object from outlines and polarized light through it",
      .synopsis = {"--out DIR [OPTION]... [manifest.json]"},
      .options = options(),
      .operands = {{.name = "MANIFEST",
                    .type = cli::Type::input_file,
                    .help = "Manifest with the views of one object; ends in .json."}},
      .reads = cli::Reads::required,
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"cameras", "images", "lights", "objects"},
      .sections_written = {"files", "meshes", "surfaces", "objects", "comparisons"},
      .files = {{"refined.ply", "the body, closed, with normals"},
                {"hull.ply", "where the refinement began: the visual hull"},
                {"maps/IMAGE.exr", "of each view: glass-net(1)'s layers, as the body has them, and the thickness, m"},
                {"held-out-hull.exr, held-out-refined.exr",
                 "the view that was kept out, rendered with either body and render(1)'s Stokes planes"},
                {"report.html", "the page: the view that was kept out beside its renderings, stages, maps"},
                {"stages.csv", "what each stage left unexplained, index, and which is the answer"}},
      .references = {"Laurentini, The visual hull concept for silhouette-based image understanding, IEEE PAMI 16(2), "
                     "1994.",
                     "Doest, James, Del Bue & Frisvad, Reconstructing transparent glass objects using polarized light, "
                     "2021.",
                     "Papandreou & Yuille, Gaussian sampling by local perturbations, NIPS 2010."},
      .see_also = {"glass-make(1)", "glass-net(1)", "render(1)", "explain(1)", "gonio-manifest(5)",
                   "gonio-conventions(7)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::glass_refine
