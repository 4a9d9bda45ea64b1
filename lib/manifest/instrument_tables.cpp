// Field tables of the sections about instruments: rigs, robots, mountings, scanners.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/acceptance.h"
#include "manifest/sections/light_position.h"
#include "manifest/sections/mounting.h"
#include "manifest/sections/rig.h"
#include "manifest/sections/robot.h"

namespace gonio::manifest {

const std::vector<Field<RigMember>>& rig_member_fields() {
  static const std::vector<Field<RigMember>> table{
      field("camera", &RigMember::camera, "", "name of the camera").needed(),
      field("rig_from_camera", &RigMember::rig_from_camera, "", "takes camera to rig coordinates").needed()};
  return table;
}

const std::vector<Field<Rig>>& rig_fields() {
  static const std::vector<Field<Rig>> table{
      field("cameras", &Rig::cameras, "", "its cameras; the first defines the rig's frame").needed(),
      field("rms_px", &Rig::rms_px, "px", "root mean square of the reprojection error over all").range(0, infinite)};
  return table;
}

const std::vector<Field<DhRow>>& dh_row_fields() {
  static const std::vector<Field<DhRow>> table{
      field("a_m", &DhRow::a_m, "m", "link length"), field("d_m", &DhRow::d_m, "m", "link offset"),
      field("alpha_rad", &DhRow::alpha_rad, "rad", "link twist"),
      field("theta_rad", &DhRow::theta_rad, "rad", "joint offset, added to the joint's angle")};
  return table;
}

const std::vector<Field<Robot>>& robot_fields() {
  static const std::vector<Field<Robot>> table{
      field("model", &Robot::model, "", "ur3, ur3e, ur5, ur5e, ur10e, abb-irb-1600, or dh with the rows below")
          .needed(),
      field("dh", &Robot::dh, "", "standard Denavit-Hartenberg rows, base to flange"),
      field("calibration", &Robot::calibration, "", "file id of a UR controller's calibration.conf")};
  return table;
}

const std::vector<Field<HeldOut>>& held_out_fields() {
  static const std::vector<Field<HeldOut>> table{
      field("rms_px", &HeldOut::rms_px, "px", "of corners").range(0, infinite),
      field("translation_m", &HeldOut::translation_m, "m", "root mean square of the position").range(0, infinite),
      field("rotation_rad", &HeldOut::rotation_rad, "rad", "root mean square of the angle").range(0, infinite)};
  return table;
}

const std::vector<Field<ScatterParts>>& scatter_parts_fields() {
  static const std::vector<Field<ScatterParts>> table{
      field("robot_m", &ScatterParts::robot_m, "m", "by the robot's poses").range(0, infinite),
      field("camera_m", &ScatterParts::camera_m, "m", "by the corners' noise and the camera's calibration")
          .range(0, infinite),
      field("board_m", &ScatterParts::board_m, "m", "by the board's shape").range(0, infinite),
      field("unexplained_m", &ScatterParts::unexplained_m, "m", "by none of them").range(0, infinite)};
  return table;
}

const std::vector<Field<Mounting>>& mounting_fields() {
  static const std::vector<Field<Mounting>> table{
      field("kind", &Mounting::kind, "", "what sits where")
          .one_of({"eye-in-hand", "eye-to-hand", "light-in-hand"})
          .needed(),
      field("robot", &Mounting::robot, "", "name of the robot"),
      field("camera", &Mounting::camera, "", "name of the camera"),
      field("board", &Mounting::board, "", "name of the board"),
      field("light", &Mounting::light, "", "name of the light"),
      field("tool_from_camera", &Mounting::tool_from_camera, "", "eye-in-hand: takes camera to tool coordinates"),
      field("base_from_board", &Mounting::base_from_board, "", "eye-in-hand: takes board to robot base coordinates"),
      field("base_from_camera", &Mounting::base_from_camera, "", "eye-to-hand: takes camera to robot base coordinates"),
      field("tool_from_board", &Mounting::tool_from_board, "", "eye-to-hand: takes board to tool coordinates"),
      field("world_from_base", &Mounting::world_from_base, "", "light-in-hand: takes robot base to world coordinates"),
      field("light_in_tool_m", &Mounting::light_in_tool_m, "m", "light-in-hand: position of the light"),
      sigma_field(&Mounting::sigma),
      field("method", &Mounting::method, "", "closed form and refinement"),
      field("corner_px", &Mounting::corner_px, "px", "estimated noise of one coordinate of a corner")
          .range(0, infinite),
      field("robot_m", &Mounting::robot_m, "m", "estimated noise of the tool's position, one coordinate")
          .range(0, infinite),
      field("robot_rad", &Mounting::robot_rad, "rad", "estimated noise of the tool's rotation, one axis")
          .range(0, infinite),
      field("scatter_m", &Mounting::scatter_m, "m", "root mean square of the board's position over the poses")
          .range(0, infinite),
      field("scatter_rad", &Mounting::scatter_rad, "rad", "root mean square of the board's angle over the poses")
          .range(0, infinite),
      field("rms_px", &Mounting::rms_px, "px", "root mean square of the reprojection error through the robot's poses")
          .range(0, infinite),
      field("held_out", &Mounting::held_out, "", "errors on poses that the fit did not see"),
      field("parts", &Mounting::parts, "", "where the scatter of the board's position comes from"),
      field("covariance", &Mounting::covariance, "", "of the fit: {\"order\": [names], \"values\": [[...]]}"),
      field("unobservable", &Mounting::unobservable, "", "directions that the poses do not determine, in words"),
      field("outliers", &Mounting::outliers, "", "ids of images that do not fit the others"),
      field("next", &Mounting::next, "", "poses to add, one sentence each")};
  return table;
}

const std::vector<Field<LightPosition>>& light_position_fields() {
  static const std::vector<Field<LightPosition>> table{
      field("id", &LightPosition::id, "", "name, unique among light positions").needed(),
      field("light", &LightPosition::light, "", "name of the light"),
      field("robot", &LightPosition::robot, "", "name of the robot that held it"),
      field("base_from_tool", &LightPosition::base_from_tool, "", "takes tool to robot base coordinates").needed(),
      field("position_m", &LightPosition::position_m, "m", "of the light, world").needed(),
      field("sigma_m", &LightPosition::sigma_m, "m", "one standard deviation, one or three numbers").range(0, infinite),
      field("covariance_m2", &LightPosition::covariance_m2, "m^2",
            "of the position, 3 x 3, row by row; then sigma_m may be left out")};
  return table;
}

const std::vector<Field<AcceptanceResult>>& acceptance_fields() {
  static const std::vector<Field<AcceptanceResult>> table{
      field("quantity", &AcceptanceResult::quantity, "", "which figure of the guideline")
          .one_of({"probing-form", "probing-size", "sphere-distance", "flatness"})
          .needed(),
      field("file", &AcceptanceResult::file, "", "file id of the point cloud"),
      field("unit", &AcceptanceResult::unit, "", "of the numbers: m"),
      field("value", &AcceptanceResult::value, "m", "worst case, as the guideline asks"),
      field("bias", &AcceptanceResult::bias, "m", "mean deviation"),
      field("sigma", &AcceptanceResult::sigma, "m", "standard deviation").range(0, infinite),
      field("limit", &AcceptanceResult::limit, "m", "largest value that was allowed").range(0, infinite),
      field("uncertainty", &AcceptanceResult::uncertainty, "m", "one standard deviation of the value")
          .range(0, infinite),
      field("count", &AcceptanceResult::count, "", "points or distances that counted"),
      field("rejected", &AcceptanceResult::rejected, "", "points left out as outliers")};
  return table;
}

GONIO_RECORD(RigMember, rig_member_fields);
GONIO_RECORD(Rig, rig_fields);
GONIO_RECORD(DhRow, dh_row_fields);
GONIO_RECORD(Robot, robot_fields);
GONIO_RECORD(HeldOut, held_out_fields);
GONIO_RECORD(ScatterParts, scatter_parts_fields);
GONIO_RECORD(Mounting, mounting_fields);
GONIO_RECORD(LightPosition, light_position_fields);
GONIO_RECORD(AcceptanceResult, acceptance_fields);

}  // namespace gonio::manifest
