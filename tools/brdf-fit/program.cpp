// brdf-fit: from measured reflectances to a surface, with its uncertainty (call.h).
#include "cli/program.h"

#include "tools/brdf-fit/call.h"

namespace gonio::tools::brdf_fit {

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "brdf-fit",
      .sentence = "tell a surface from measured reflectances",
      .synopsis = {"[OPTION]... TABLE...", "[OPTION]... [-i FILE | recording.json]",
                   "--reconstruct --merl FILE [--basis PATH] TABLE", "--plan N [--basis PATH]", "--example"},
      .options = options(),
      .operands = {{.name = "FILE",
                    .type = cli::Type::input_file,
                    .help = "Tables of reflectances (.brdf of Cornell, .binary of MERL, else text in columns), or one "
                            "manifest that ends in .json.",
                    .repeat = true}},
      .standalone = {"plan", "example"},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"files", "tables", "goniometer", "images", "cameras", "lights", "surfaces", "mechanisms"},
      .sections_written = {"files", "surfaces", "surface_fits", "tables"},
      .files = {{"NAME.html", "the report page"},
                {"NAME.csv", "samples with prediction and residual"},
                {"NAME.binary", "--reconstruct: the whole table in MERL's format"},
                {"NAME-sigma.binary", "--reconstruct: one standard deviation of every cell, 1/sr, in that format"},
                {"NAME-sphere.png", "a sphere of the surface"},
                {"NAME-scans.svg", "scans in the plane of incidence, measured and fitted"},
                {"NAME-lobes.svg", "lobes around the normal, measured and fitted"},
                {"NAME-residuals.svg", "where the surface errs, over half and difference angle"},
                {"NAME-numbers.csv", "what was fitted, with intervals"},
                {"NAME-spectrum-NUMBER.svg", "of more than three bands: albedo, f0, ... over wavelength"}},
      .exits = {{Exit::negative, "These samples tell no surface."},
                {Exit::quality,
                 "Written, but the fit did not converge, reflects more than it receives, errs more than a constant "
                 "would, or errs on held-out directions by half as much again as on fitted ones."}},
      .references = {"J. Nielsen, H. Jensen, R. Ramamoorthi, On optimal, minimal BRDF sampling for reflectance "
                     "acquisition, ACM TOG 34(6), 2015.",
                     "L. Belcour, P. Barla, R. Pacanowski, ALTA: a BRDF analysis library, MAM 2014.",
                     "W. Matusik et al., A data-driven reflectance model, ACM TOG 22(3), 2003.",
                     "J. Low et al., BRDF models for accurate and efficient rendering of glossy surfaces, ACM TOG "
                     "31(1), 2012."},
      .see_also = {"render(1)", "explain(1)", "gonio-surfaces(7)", "gonio-manifest(5)", "gonio-conventions(7)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::brdf_fit
