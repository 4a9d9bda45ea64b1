// lobe: the BRDF of a height map, by tracing paths over a patch of it (lib/relief/lobe.h).
#include "cli/height_maps.h"
#include "relief/document.h"
#include "tools/lobe/call.h"

namespace gonio::tools::lobe {

using namespace gonio::relief;

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "lobe",
      .sentence = "the lobe of reflected light of a height map, by path tracing a patch of it",
      .synopsis = {"[OPTION]... MAP...", "[OPTION]... [-i FILE | manifest.json]"},
      .options = options(),
      .operands = {cli::map_operand()},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"files", "reliefs"},
      .sections_written = {"files", "reliefs", "tables", "surfaces", "surface_fits"},
      .files = {{"NAME-lobe.csv", "f and its sigma by both directions, 1/sr"},
                {"NAME-lobe-ANGLE.png", "the hemisphere from above in false colours"}},
      .references = {"Westin, Arvo & Torrance, Predicting reflectance functions from complex surfaces, SIGGRAPH 1992.",
                     "Tevs, Ihrke & Seidel, Maximum mipmaps for fast, accurate, and scalable dynamic height field "
                     "rendering, I3D 2008."},
      .see_also = {"roughness(1)", "relief(1)", "brdf-fit(1)", "gonio-surfaces(7)", "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::lobe
