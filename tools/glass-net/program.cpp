// glass-net: what a trained network says of photographs of glass (lib/glass/net).
#include "tools/glass-net/call.h"

namespace gonio::tools::glass_net {

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "glass-net",
      .sentence = "find glass, its depth and the normals of its front and back in photographs of a polarization camera",
      .synopsis = {"--weights DIR --out DIR [OPTION]... PHOTOGRAPH...",
                   "--weights DIR --out DIR [OPTION]... [recordings.json]",
                   "--weights DIR --reliability SET [--share SHARE]"},
      .options = options(),
      .operands = {{.name = "PHOTOGRAPH",
                    .type = cli::Type::input_file,
                    .help = "Mosaics as the camera read them (EXR, PNG, TIFF, camera raws), or EXR files with Stokes "
                            "vectors; else all images of the manifest with a file.",
                    .repeat = true}},
      .standalone = {"reliability"},
      .takes_out = true,
      .sections_read = {"files", "images"},
      .sections_written = {"files", "images"},
      .files = {{"ID.exr",
                 "mask; depth.Z, m; normal.X/Y/Z of the front and back_normal.X/Y/Z of the back in the world's frame "
                 "(without a pose the camera's); uncertainty.depth.Z, m, uncertainty.normal and "
                 "uncertainty.back_normal, rad, that 68.3 % err by less than"},
                {"report.html", "all of them as pictures"}},
      .exits = {{Exit::negative, "with --reliability: a calibration error is larger than --most"}},
      .references = {"Doest, James, Del Bue & Frisvad, Reconstructing transparent glass objects using polarized light, "
                     "2021.",
                     "Guo, Pleiss, Sun & Weinberger, On calibration of modern neural networks, ICML 2017.",
                     "Kuleshov, Fenner & Ermon, Accurate uncertainties for deep learning using calibrated regression, "
                     "ICML 2018."},
      .see_also = {"glass-make(1)", "develop(1)", "render(1)", "gonio-manifest(5)", "gonio-conventions(7)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::glass_net
