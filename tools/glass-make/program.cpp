// glass-make: pictures of glass before a screen, as a polarization camera takes them, with what is to be learnt from
// them (lib/glass/set.h).
#include "tools/glass-make/call.h"

namespace gonio::tools::glass_make {

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "glass-make",
      .sentence = "make training data of glass before a screen, with polarization",
      .synopsis = {"--out DIR [OPTION]...", "--out DIR --shard I/N [OPTION]...", "--out DIR --gather [OPTION]..."},
      .options = options(),
      .takes_out = true,
      .takes_seed = true,
      .takes_resume = true,
      .sections_written = {"files"},
      .files = {{"cells/NAME/cell.json", "a cell's scene and pictures: a manifest; there when the cell is finished"},
                {"cells/NAME/bare.exr, lit.exr",
                 "render(1)'s layers with Stokes vectors, under the screen's light alone and with the room's"},
                {"cells/NAME/bare-mosaic.exr, lit-mosaic.exr", "what a polarization camera reads, with its noise"},
                {"meshes, files", "what cells share: bodies, pictures of screens and rooms, spectra; named by content"},
                {"tensors/SHARE-INPUT.npy",
                 "training, validation and test data as arrays [cell, channel, row, column]"},
                {"object-NUMBER.json, masks",
                 "with --recording: the views of an object as one recording, as glass-refine(1) reads it"},
                {"cells.csv", "one line a cell: what it is, its share, its coverage, its noise"},
                {"report.html", "what the set is made of"}},
      .references = {"Doest, James, Del Bue & Frisvad, Reconstructing transparent glass objects using polarized light, "
                     "2021.",
                     "Sajjan et al., ClearGrasp: 3D shape estimation of transparent objects for manipulation, ICRA "
                     "2020."},
      .see_also = {"glass-refine(1)", "render(1)", "scene(1)", "develop(1)", "gonio-manifest(5)",
                   "gonio-conventions(7)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::glass_make
