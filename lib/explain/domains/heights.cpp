// Height maps: is the surface isotropic, or has it a lay or ridges?
#include "explain/domain.h"
#include "explain/heights/heights_problem.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::explain::domains {

const Domain& heights() {
  static const Domain domain{
      .name = "heights",
      .sentence = "a table of the model \"heights\", whose file is a height map (.sur, .opd, .nms, .x3p, .plu, OpenEXR, TIFF)",
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
          }};
  return domain;
}

}  // namespace gonio::explain::domains
