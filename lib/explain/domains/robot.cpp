// Hand-eye sets: board poses against the robot's own.
#include "manifest/sections/robot.h"

#include "explain/domain.h"
#include "explain/robot/robot_problem.h"
#include "explain/robot/robot_witness.h"
#include "manifest/document.h"

namespace gonio::explain::domains {

namespace {

std::vector<std::filesystem::path> calibrations_of(const manifest::Document& document) {
  std::vector<std::filesystem::path> files;
  for (const auto& [name, robot] : document.robots)
    if (!robot.calibration.empty())
      files.push_back(manifest::resolve(document, robot.calibration, "/robots/" + name + "/calibration"));
  return files;
}

std::vector<std::unique_ptr<Problem>> mountings(const manifest::Document& document, const ProblemOptions&) {
  std::vector<std::unique_ptr<Problem>> problems;
  for (ChainInput& input : robot_inputs(document)) problems.push_back(robot_problem(std::move(input)));
  return problems;
}

}  // namespace

const Domain& robot() {
  static const Domain domain{
      .name = "robot",
      .sentence = "a mounting on a robot with at least six posed images (handeye)",
      .order = 3,
      .leaves = "lens.",
      .leaves_to = "boards",
      .witness_of = "boards",
      .testify = hand_eye_testimony,
      .applies = has_hand_eye,
      .problems = mountings,
      .files = calibrations_of,
      .untouched = {
          {"polarizer.", "poses say nothing of how light swings"},
          {"screen.", "poses say nothing of how light swings"},
          {"retarder.", "poses say nothing of how light swings"},
          {"print.", "an arm prints nothing"},
          {"projector.", "poses come from boards; no projector shows codes"},
          {"rig.", "poses come from boards; no projector shows codes"},
          {"structured-light.", "poses come from boards; no projector shows codes"},
          {"board.corner-bias",
           "a constant shift of all corners is the camera's mounting, by which they are held; boards shows it"},
          {"board.print", "left to boards, which has the corners themselves: poses average over it"},
          {"board.shape", "left to boards, which has the corners themselves: poses average over it"},
          {"lens.", "poses say of it what the terms that are asked say; all others are left to boards"},
          {"camera.rolling-shutter",
           "the arm stands still while a picture is taken; robot.time-offset is the delay of what moves"},
          {"camera.flat-port", "left to boards, which has the corners: poses seen through it are off together"},
          {"camera.thermal",
           "hand-eye sets state no temperature of the camera; corners with a column of it are boards"},
          {"robot.axis-scale", "needs places that a tracker measured, a table of the model tracker"},
          {"robot.squareness", "needs places that a tracker measured, a table of the model tracker"},
          {"robot.compliance", "needs places that a tracker measured, a table of the model tracker"},
          {"robot.friction-heating", "needs temperatures of the joints, a table of the model temperature"},
          {"robot.joule-heating", "needs temperatures of the joints, a table of the model temperature"},
          {"robot.warm-up", "needs temperatures of the joints, a table of the model temperature"},
          {"camera.aspect", "the base model's own: free where the poses come with their corners"},
          {"camera.focal-length", "the base model's own: free where the poses come with their corners"},
          {"camera.principal-point", "the base model's own: free where the poses come with their corners"},
          {"camera.pose", "where the camera sits is the mounting, which is free"},
          {"light.", "poses are places, and keep no brightness"},
          {"optics.", "poses are places, and keep no brightness"},
          {"sensor.", "poses are places, and keep no brightness"},
          {"surface.", "poses are places, and keep no brightness"},
          {"volume.", "poses are places, and keep no brightness"},
          {"scene.", "the board stands still, and each pose of it is held against the arm"},
          {"transport.", "poses are places, and keep no brightness"},
          {"reference.", "poses are places, and keep no brightness"},
          {"ground.", "what an arm tells are poses, and no rims"},
          {"mask.", "what an arm tells are poses, and no rims"},
          {"geometry.", "the board stands still and is measured; where it stands and where the camera sits is free"},
          {"tracks.", "no shape deforms, and corners are named"},
          {"marker.", "poses come from boards; markers of other kinds are tables of the model markers"},
          {"ct.", "no X-rays"},
          {"colour.", "poses are places, and keep no brightness"},
          {"probe.", "a robot that carries a board carries no mirror ball"}}};
  return domain;
}

}  // namespace gonio::explain::domains
