// Measured maps of printed surfaces against what was sent to the printer.
#include "explain/domain.h"
#include "explain/prints/prints_problem.h"

namespace gonio::explain::domains {

const Domain& prints() {
  static const Domain domain{
      .name = "prints",
      .sentence = "prints with \"measured\" maps of what was printed",
      .order = 8,
      .applies = has_prints,
      .problems =
          [](const manifest::Document& document, const ProblemOptions& options) {
            std::vector<std::unique_ptr<Problem>> problems;
            for (PrintsInput& input : prints_inputs(document, options))
              problems.push_back(prints_problem(std::move(input)));
            return problems;
          },
      .files = prints_files,
      .untouched = {
          {"polarizer.", "a height map has no light"},
          {"screen.", "a height map has no light"},
          {"retarder.", "a height map has no light"},
          {"surface.", "a map of heights says nothing of what light does on the surface"},
          {"light.", "the projector's light is what was sent; what it does to resin is print.growth and print.bleed"},
          {"optics.",
           "what the projector's lens does is print.bleed and print.pixel-tilt; the instrument's resolution "
           "is free"},
          {"sensor.", "a height map has heights and no grey levels"},
          {"scene.", "nothing moves between recordings"},
          {"transport.", "light between layers is print.overcure"},
          {"volume.", "what resin does to light is print.overcure"},
          {"reference.", "the reference is what was sent, and no white tile"},
          {"ground.", "a height map has no light and no rims"},
          {"mask.", "a height map has no light and no rims"},
          {"geometry.",
           "what a print shows of it has the names print.shrinkage and print.layer-shift; where a map lies "
           "is free"},
          {"lens.", "a height map has been rectified by its instrument"},
          {"camera.", "a height map has no camera"},
          {"board.", "a print is no board of corners"},
          {"robot.", "a printer moves along one axis: print.layer-shift"},
          {"tracks.", "nothing moves"},
          {"marker.", "a print has no markers"},
          {"ct.", "no X-rays"},
          {"colour.", "a height map has no colours"},
          {"probe.", "a map of heights has no mirror ball beside it"},
          {"projector.", "the projector shows no codes; its grey values are print.growth, its lens print.bleed"},
          {"rig.", "a printer's projector stands still"},
          {"structured-light.", "the projector shows no codes"}}};
  return domain;
}

}  // namespace gonio::explain::domains
