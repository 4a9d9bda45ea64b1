// "mountings": results of hand-eye calibrations.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"
#include "manifest/pose.h"
#include "manifest/value.h"

namespace gonio::manifest {

struct HeldOut {  // of images that the fit did not see
  std::optional<double> rms_px, translation_m, rotation_rad;
};
// Where the scatter of a hand-eye calibration comes from, as standard deviations of the board's position.
struct ScatterParts {
  std::optional<double> robot_m, camera_m, board_m, unexplained_m;
};
// "mountings": what is fixed to a robot's tool or stands in its world, as handeye found it.
// eye-in-hand: tool_from_camera, base_from_board. eye-to-hand: base_from_camera, tool_from_board.
// light-in-hand: light_in_tool_m, world_from_base.
struct Mounting {
  std::string kind, robot, camera, board, light;
  std::optional<Pose<frame::Tool, frame::Camera>> tool_from_camera;
  std::optional<Pose<frame::Base, frame::Board>> base_from_board;
  std::optional<Pose<frame::Base, frame::Camera>> base_from_camera;
  std::optional<Pose<frame::Tool, frame::Board>> tool_from_board;
  std::optional<Pose<frame::World, frame::Base>> world_from_base;
  std::vector<double> light_in_tool_m;
  Sigmas sigma;
  std::string method;                                    // closed form and refinement
  std::optional<double> corner_px, robot_m, robot_rad;   // estimated noise, one coordinate
  std::optional<double> scatter_m, scatter_rad, rms_px;  // of the fit
  std::optional<HeldOut> held_out;
  std::optional<ScatterParts> parts;
  Value covariance;                                       // {"order": [...], "values": [[...]]} or null
  std::vector<std::string> unobservable, outliers, next;  // directions; image ids; poses to add, in words
};

}  // namespace gonio::manifest
