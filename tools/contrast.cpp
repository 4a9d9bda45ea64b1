// contrast: what contrast a micro-structured surface will show when it is turned (lib/contrast/predict.h), and what
// contrast photographs of one show.
#include <iostream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "cli/program.h"
#include "contrast/predict_call.h"

namespace gonio::tools::contrast {
namespace {

using cli::Type;
namespace contrasts = gonio::contrast;

Exit run(cli::Invocation& call) {
  return contrasts::predict_call(call);
}

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = contrasts::predict_options();
  all.push_back(
      {.name = "html", .type = Type::output_file, .help = "Write the report: one page that needs no network."});
  return all;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "contrast",
      .sentence = "predict and measure the contrast of micro-structured surfaces that are turned",
      .synopsis = {"predict [OPTION]... [manifest.json]"},
      .options = options(),
      .operands =
          {{.name = "ACTION", .type = Type::choice, .help = "What to do.", .choices = {"predict"}, .required = true}},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"files", "mechanisms", "surfaces"},
      .sections_written = {"files"},
      .files = {{"contrasts.csv", "predict: every combination, angles in degrees, signals in 1/sr"},
                {"means.csv", "predict: mean contrasts by tilt, by each varied parameter, by pair of rotations"}},
      .references = {"Luongo, Falster, Doest, Li, Regi, Zhang, Tosello, Nielsen, Aanaes & Frisvad, Modeling the "
                     "anisotropic reflectance of a surface with microstructure engineered to obtain visible contrast "
                     "after rotation, ICCVW 2017.",
                     "JCGM 101:2008, Propagation of distributions using a Monte Carlo method."},
      .see_also = {"gonio-surfaces(7)", "render(1)", "explain(1)", "gonio-manifest(5)"},
      .check = contrasts::predict_check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::contrast
