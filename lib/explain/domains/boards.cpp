// Board corners, as calib-charuco writes them.
#include "explain/boards/boards_problem.h"
#include "explain/domain.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::explain::domains {

const Domain& boards() {
  static const Domain domain{
      .name = "boards",
      .sentence = "tables of board corners with their cameras and boards (calib-charuco)",
      .order = 1,
      .applies = has_boards,
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems;
            problems.push_back(boards_problem(boards_input(document)));
            return problems;
          },
      .files =
          [](const manifest::Document& document) {
            std::vector<std::filesystem::path> files;
            for (const auto& [name, table] : document.tables)
              if (table.model == "camera" && !table.file.empty())
                files.push_back(manifest::resolve(document, table.file, "/tables/" + name + "/file"));
            return files;
          }};
  return domain;
}

}  // namespace gonio::explain::domains
