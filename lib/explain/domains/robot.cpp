// Hand-eye sets: board poses against the robot's own.
#include "manifest/sections/robot.h"

#include "explain/domain.h"
#include "explain/robot/robot_problem.h"
#include "manifest/document.h"

namespace gonio::explain::domains {

const Domain& robot() {
  static const Domain domain{
      .name = "robot",
      .sentence = "a mounting on a robot with at least six posed images (handeye)",
      .order = 3,
      .leaves = "lens.",
      .leaves_to = "boards",
      .applies = has_hand_eye,
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems;
            for (ChainInput& input : robot_inputs(document)) problems.push_back(robot_problem(std::move(input)));
            return problems;
          },
      .files =
          [](const manifest::Document& document) {
            std::vector<std::filesystem::path> files;
            for (const auto& [name, robot] : document.robots)
              if (!robot.calibration.empty())
                files.push_back(manifest::resolve(document, robot.calibration, "/robots/" + name + "/calibration"));
            return files;
          }};
  return domain;
}

}  // namespace gonio::explain::domains
