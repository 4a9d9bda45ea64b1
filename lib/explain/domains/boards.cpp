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
      .objects = boards_objection,
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
          },
      .untouched =
          {{"polarizer.", "corners say where light goes, not how it swings"},
           {"screen.", "corners say where light goes, not how it swings"},
           {"retarder.", "corners say where light goes, not how it swings"},
           {"lens.birefringence", "corners say where light goes, not how it swings"},
           {"print.", "a board of corners has no printed heights"},
           {"light.", "corners are places, and keep no brightness"},
           {"camera.aspect", "the base model's own: free in every calibration from corners"},
           {"camera.principal-point", "the base model's own: free in every calibration from corners"},
           {"camera.pose", "every view's pose is free"},
           {"optics.",
            "blur, glare and falloff change how bright a corner's squares are, and leave the corner between them"},
           {"sensor.", "corners are places; how wrong grey levels move them all alike is board.corner-bias"},
           {"surface.", "corners are places, and keep no brightness"},
           {"volume.", "nothing lies between board and camera that light goes through"},
           {"scene.", "every view has its own pose: a board may move between them"},
           {"transport.", "corners are places, and keep no brightness"},
           {"ground.", "corners lie on boards, and have no outline against a ground"},
           {"mask.", "corners lie on boards, and have no outline against a ground"},
           {"geometry.", "every view's pose is free, and the board's own shape is board.warp and board.scale"},
           {"reference.", "corners are places, and keep no brightness"},
           {"robot.", "no robot is known here: hand-eye sets (robot) have its joints"},
           {"tracks.", "a board is rigid and its corners are named: no track can slip, no shape deforms"},
           {"marker.", "markers of other kinds are tables of the model markers"},
           {"ct.", "no X-rays"},
           {"colour.",
            "corners are places, and keep no brightness: readings of a colour chart are tables of the model chart"},
           {"probe.", "corners of boards show no mirror ball: highlights are tables of the model probe"},
           {"projector.", "corners are seen by cameras alone"},
           {"rig.", "every view has a pose of its own, whatever holds its camera"},
           {"structured-light.", "corners are seen by cameras alone"}}};
  return domain;
}

}  // namespace gonio::explain::domains
