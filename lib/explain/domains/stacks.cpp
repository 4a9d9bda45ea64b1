// Stacks of pictures of one static scene without geometry.
#include "explain/domain.h"
#include "explain/stacks/exposures_problem.h"
#include "explain/stacks/photometric_problem.h"
#include "manifest/document.h"
#include "manifest/image_list.h"

namespace gonio::explain::domains {

const Domain& stacks() {
  static const Domain domain{
      .name = "stacks",
      .sentence =
          "pictures of one static scene without objects: three exposures with exposure_s, or six under distant "
          "lamps",
      .order = 4,
      .applies =
          [](const manifest::Document& document) {
            using namespace explain::stacks;
            return !stacks_of(document, Kind::exposures).empty() || !stacks_of(document, Kind::lights).empty();
          },
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems = explain::stacks::exposures_problems(document);
            for (std::unique_ptr<Problem>& p : explain::stacks::photometric_problems(document))
              problems.push_back(std::move(p));
            return problems;
          },
      .files =
          [](const manifest::Document& document) {
            std::vector<std::filesystem::path> files;
            for (const explain::stacks::Kind kind : {explain::stacks::Kind::exposures, explain::stacks::Kind::lights})
              for (const std::vector<std::size_t>& entries : explain::stacks::stacks_of(document, kind))
                for (const std::size_t i : entries)
                  for (auto& file : manifest::files_of_image(document, i)) files.push_back(file);
            return files;
          }};
  return domain;
}

}  // namespace gonio::explain::domains
