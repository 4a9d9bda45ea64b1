// See domains.h.
#include "explain/domains.h"

#include <algorithm>

#include "base/error.h"
#include "explain/boards/boards_problem.h"
#include "explain/images/images_problem.h"
#include "explain/robot/robot_problem.h"

namespace gonio::explain {

std::vector<std::unique_ptr<Problem>> problems_of(const manifest::Document& document) {
  std::vector<std::unique_ptr<Problem>> problems;
  if (has_boards(document)) problems.push_back(boards_problem(boards_input(document)));
  if (images::has_recordings(document)) problems.push_back(std::make_unique<images::ImagesProblem>(document));
  if (has_hand_eye(document))
    for (RobotInput& input : robot_inputs(document)) problems.push_back(robot_problem(std::move(input)));
  if (problems.empty())
    throw Error(
        Exit::data, manifest::place(document, ""),
        "has nothing to explain: no table of board corners, no mounting on a robot, no recorded images of objects",
        "calibrate with calib-charuco or handeye, or describe images with file and camera, and objects");
  return problems;
}

std::vector<std::filesystem::path> files_of(const manifest::Document& document) {
  std::vector<std::filesystem::path> files;
  const auto add = [&](const std::string& id, const std::string& pointer) {
    if (!id.empty()) files.push_back(manifest::resolve(document, id, pointer));
  };
  for (const auto& [name, table] : document.tables)
    if (table.model == "camera") add(table.file, "/tables/" + name + "/file");
  for (const auto& [name, robot] : document.robots) add(robot.calibration, "/robots/" + name + "/calibration");
  if (images::has_recordings(document)) {
    for (std::size_t i = 0; i < document.images.size(); ++i) {
      add(document.images[i].file, "/images/" + std::to_string(i) + "/file");
      add(document.images[i].mask, "/images/" + std::to_string(i) + "/mask");
    }
    for (const auto& [name, mesh] : document.meshes) add(mesh.file, "/meshes/" + name + "/file");
  }
  return files;
}

}  // namespace gonio::explain
