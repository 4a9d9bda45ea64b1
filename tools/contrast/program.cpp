// contrast: what contrast a micro-structured surface will show when it is turned (lib/contrast/predict/predict.h), and
// what contrast photographs of one show.
#include <iostream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "cli/common_options.h"
#include "tools/contrast/measure.h"
#include "tools/contrast/predict.h"

namespace gonio::tools::contrast {
namespace {

using cli::Type;

bool measures(const cli::Invocation& call) {
  return call.text("ACTION") == "measure";
}

// Options of the one action do nothing in the other: better said than passed over.
void check(cli::Invocation& call) {
  const bool measure = measures(call);
  for (const cli::Option& option : measure ? predict_options() : measure_options())
    if (call.given(option.name))
      throw Error(Exit::usage, "--" + option.name, std::string("is no option of ") + (measure ? "measure" : "predict"),
                  "leave it out, or use contrast " + std::string(measure ? "predict" : "measure"));
  measure ? check_measure(call) : check_predict(call);
}

Exit run(cli::Invocation& call) {
  return measures(call) ? run_measure(call) : run_predict(call);
}

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = predict_options();
  const std::vector<cli::Option> measure = measure_options();
  all.insert(all.end(), measure.begin(), measure.end());
  all.push_back(cli::report_option());
  return all;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "contrast",
      .sentence = "predict and measure the contrast of micro-structured surfaces that are turned",
      .synopsis = {"predict [OPTION]... [manifest.json]", "measure [--corners CSV] [OPTION]... session.json"},
      .options = options(),
      .operands = {{.name = "ACTION",
                    .type = Type::choice,
                    .help = "What to do.",
                    .choices = {"predict", "measure"},
                    .required = true},
                   {.name = "MANIFEST",
                    .type = Type::input_file,
                    .help = "predict: a manifest with the surface; measure: one with the pattern and its images."}},
      .takes_out = true,
      .takes_seed = true,
      .sections_read = {"cameras", "files", "images", "mechanisms", "patterns", "surfaces", "tables"},
      .sections_written = {"contrasts", "files", "patterns", "surfaces"},
      .files = {{"contrasts.csv", "predict: every combination, angles in degrees, signals in 1/sr"},
                {"means.csv", "predict: mean contrasts by tilt, by each varied parameter, by pair of rotations"},
                {"optimum.csv", "predict --optimize: the optimum, its bounds, and how much each parameter matters"},
                {"views.csv", "measure: signals and contrasts of every view, with their sigmas"},
                {"cells.csv", "measure: bit, contrast of the turn, distance from the class and p of every cell"},
                {"series.csv", "measure: mean radiance of every cell in every view"},
                {"pattern.png, turn.png, distance.png", "measure: maps of the cells, upright in the sample's frame"}},
      .exits = {{Exit::negative, "measure found cells that behave unlike their class"}},
      .references = {"Luongo, Falster, Doest, Li, Regi, Zhang, Tosello, Nielsen, Aanaes & Frisvad, Modeling the "
                     "anisotropic reflectance of a surface with microstructure engineered to obtain visible contrast "
                     "after rotation, ICCVW 2017.",
                     "Regi, Doest, Loaldi, Li, Frisvad, Tosello & Zhang, Functionality characterization of injection "
                     "moulded micro-structured surfaces, Precision Engineering 60, 2019.",
                     "ISO/IEC 16022:2006, Data Matrix bar code symbology specification.",
                     "Schaefer & Strimmer, A shrinkage approach to large-scale covariance matrix estimation, Stat. "
                     "Appl. Genet. Mol. Biol. 4, 2005.",
                     "JCGM 101:2008, Propagation of distributions using a Monte Carlo method."},
      .see_also = {"gonio-surfaces(7)", "render(1)", "explain(1)", "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::contrast
