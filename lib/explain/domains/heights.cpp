// Height maps: is the surface isotropic, or has it a lay or ridges?
#include "explain/domain.h"
#include "explain/heights/heights_problem.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::explain::domains {

const Domain& heights() {
  static const Domain domain{
      .name = "heights",
      .sentence =
          "a table of the model \"heights\", whose file is a height map (.sur, .opd, .nms, .x3p, .plu, OpenEXR, TIFF)",
      .order = 5,
      .applies = has_heights,
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems;
            for (HeightsInput& input : heights_inputs(document)) problems.push_back(heights_problem(std::move(input)));
            return problems;
          },
      .files =
          [](const manifest::Document& document) {
            std::vector<std::filesystem::path> files;
            for (const auto& [name, table] : document.tables)
              if (table.model == "heights")
                files.push_back(manifest::resolve(document, table.file, "/tables/" + name + "/file"));
            return files;
          },
      .untouched =
          {{"polarizer.", "a height map has no light"},
           {"screen.", "a height map has no light"},
           {"retarder.", "a height map has no light"},
           {"print.", "what was sent to a printer is not known of a map: explain takes prints with measured maps"},
           {"surface.", "it changes what light does, and leaves the relief as it is; a height map has no light"},
           {"light.", "a height map has no light"},
           {"optics.", "how an instrument sees is in its own transfer function, which a height map does not state"},
           {"sensor.", "a height map has heights and no grey levels"},
           {"scene.", "a height map is one recording"},
           {"transport.", "a height map has no light"},
           {"volume.", "a height map ends at the surface"},
           {"reference.", "a height map is held against no reference"},
           {"ground.", "a height map has no light and no rims"},
           {"mask.", "a height map has no light and no rims"},
           {"geometry.",
            "a height map is levelled and held against no shape: where it stands and how large it is stays unknown"},
           {"lens.", "a height map has been rectified by its instrument; its scales are those that its file states"},
           {"camera.", "a height map has no camera"},
           {"board.", "a height map has no board"},
           {"robot.", "a height map has no robot"},
           {"tracks.", "a height map does not move"},
           {"marker.", "a height map has no markers"},
           {"ct.", "no X-rays"},
           {"colour.", "a height map has no light"},
           {"probe.", "a map of heights has no mirror ball beside it"},
           {"projector.", "a height map states no projector"},
           {"rig.", "a height map states no projector"},
           {"structured-light.", "a height map states no projector"}}};
  return domain;
}

}  // namespace gonio::explain::domains
