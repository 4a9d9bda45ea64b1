// Field tables of the laboratory, of plans and of runs.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/plan.h"

namespace gonio::manifest {

const std::vector<Field<SolidBody>>& solid_body_fields() {
  static const std::vector<Field<SolidBody>> table{
      field("name", &SolidBody::name, "", "for messages").needed(),
      field("box_m", &SolidBody::box_m, "m", "a box: its full sides [x, y, z]").positive(),
      field("ball_m", &SolidBody::ball_m, "m", "a ball: its radius").positive(),
      field("cylinder_m", &SolidBody::cylinder_m, "m", "a cylinder about its z: [radius, length]").positive(),
      field("mesh", &SolidBody::mesh, "", "file id of a PLY or STL file, in metres"),
      field("world_from_body", &SolidBody::world_from_body, "", "where it stands; left out: identity"),
      field("tool_from_body", &SolidBody::tool_from_body, "", "carried by a robot: takes body to tool coordinates"),
      field("base_from_body", &SolidBody::base_from_body, "",
            "of a robot's link: takes body to base coordinates while all joints are at zero; left out: identity")};
  return table;
}

const std::vector<Field<JointLimits>>& joint_limits_fields() {
  static const std::vector<Field<JointLimits>> table{
      field("lower_rad", &JointLimits::lower_rad, "rad", "smallest angle, one a joint"),
      field("upper_rad", &JointLimits::upper_rad, "rad", "largest angle, one a joint"),
      field("speed_rad_per_s", &JointLimits::speed_rad_per_s, "rad/s", "one a joint").positive(),
      field("acceleration_rad_per_s2", &JointLimits::acceleration_rad_per_s2, "rad/s^2", "one a joint").positive()};
  return table;
}

const std::vector<Field<CableSlack>>& cable_slack_fields() {
  static const std::vector<Field<CableSlack>> table{
      field("free_rad", &CableSlack::free_rad, "rad", "joint angles at which the cable hangs free").needed(),
      field("slack_rad", &CableSlack::slack_rad, "rad", "how far each joint may turn from there, to either side")
          .range(0, infinite)
          .needed()};
  return table;
}

const std::vector<Field<LaboratoryRobot>>& laboratory_robot_fields() {
  using R = LaboratoryRobot;
  static const std::vector<Field<R>> table{
      field("url", &R::url, "", "reaches its controller: modbus://host:port, sim://"),
      field("model", &R::model, "", "an arm known by name, dh with the rows below, or urdf with a file").needed(),
      field("dh", &R::dh, "", "standard Denavit-Hartenberg rows, base to flange"),
      field("urdf", &R::urdf, "", "file id of its description"),
      field("calibration", &R::calibration, "", "file id of a UR controller's calibration.conf"),
      field("registers", &R::registers, "", "file id of the register map of a controller that is not a UR"),
      field("world_from_base", &R::world_from_base, "", "where it stands; left out: identity"),
      field("limits", &R::limits, "", "of its joints; left out: the model's"),
      field("cable", &R::cable, "", "how far it may be wound"),
      field("payload_kg", &R::payload_kg, "kg", "at its flange").range(0, infinite),
      field("payload_centre_m", &R::payload_centre_m, "m", "centre of mass, tool coordinates"),
      field("home_rad", &R::home_rad, "rad", "joint angles at which a run begins and ends"),
      field("carries", &R::carries, "", "solids fixed to its tool"),
      field("links", &R::links, "",
            "solids of its links instead of the model's, named link-0 (its base), link-1, link-1-motor, ...")};
  return table;
}

const std::vector<Field<LaboratoryCamera>>& laboratory_camera_fields() {
  using C = LaboratoryCamera;
  static const std::vector<Field<C>> table{
      field("url", &C::url, "", "reaches it: genicam://address, gphoto2://, v4l2://, folder://PATH, sim://"),
      field("robot", &C::robot, "", "that holds it; left out: it stands"),
      field("tool_from_camera", &C::tool_from_camera, "", "held: takes camera to tool coordinates"),
      field("world_from_camera", &C::world_from_camera, "", "standing: takes camera to world coordinates"),
      field("pixel_format", &C::pixel_format, "", "as GenICam names it: Mono12Packed, BayerRG16, ..."),
      field("exposure_s", &C::exposure_s, "s", "[shortest, longest] that it can").positive(),
      field("gain_db", &C::gain_db, "dB", "set before a run"),
      field("trigger", &C::trigger, "", "what starts an exposure").one_of({"software", "hardware"}),
      field("white", &C::white, "", "code from which a pixel counts as saturated").positive(),
      field("codes_per_radiance_s", &C::codes_per_radiance_s, "m^2 sr/(W s)",
            "of a linear camera: codes for a radiance of 1 W/(m^2 sr) in 1 s")
          .positive(),
      field("black_code", &C::black_code, "", "mean code without light; left out: 0").range(0, infinite),
      field("electrons_per_code", &C::electrons_per_code, "", "whose shot noise a code has (EMVA 1288: 1 / K)")
          .positive(),
      field("read_electrons", &C::read_electrons, "", "noise without light, one standard deviation").range(0, infinite),
      field("filters", &C::filters, "",
            "of a simulated colour camera: three rows of what its red, green and blue pass of the scene's; left out: "
            "each "
            "its own")};
  return table;
}

const std::vector<Field<LaboratoryLamp>>& laboratory_lamp_fields() {
  using L = LaboratoryLamp;
  static const std::vector<Field<L>> table{
      field("url", &L::url, "", "reaches its switch: modbus://host:port/coil/3, command:, serial://, sim://"),
      field("robot", &L::robot, "", "that holds it; left out: it stands"),
      field("light", &L::light, "", "name in lights; left out: its own name"),
      field("in_tool_m", &L::in_tool_m, "m", "held: its position, tool coordinates"),
      field("in_world_m", &L::in_world_m, "m", "standing: its position"),
      field("settle_s", &L::settle_s, "s", "from switching to a steady light").range(0, infinite)};
  return table;
}

const std::vector<Field<LaboratoryTurntable>>& laboratory_turntable_fields() {
  using T = LaboratoryTurntable;
  static const std::vector<Field<T>> table{
      field("url", &T::url, "", "reaches it: modbus://host:port/register/100, serial://, sim://"),
      field("world_from_table", &T::world_from_table, "", "at angle 0; it turns about its z"),
      field("range_rad", &T::range_rad, "rad", "[smallest, largest] angle; left out: it turns on and on"),
      field("speed_rad_per_s", &T::speed_rad_per_s, "rad/s", "largest").positive(),
      field("acceleration_rad_per_s2", &T::acceleration_rad_per_s2, "rad/s^2", "largest").positive(),
      field("carries", &T::carries, "", "objects that turn with it"),
      field("deforms", &T::deforms, "",
            "objects whose meshes go through their shapes while it turns once; carrying none, it turns nothing else")};
  return table;
}

const std::vector<Field<LaboratoryScreen>>& laboratory_screen_fields() {
  using S = LaboratoryScreen;
  static const std::vector<Field<S>> table{
      field("url", &S::url, "", "reaches it: window://1, command:, sim://"),
      field("kind", &S::kind, "", "what it is").one_of({"lcd", "projector"}).needed(),
      field("width_px", &S::width_px, "px", "columns").range(1, 1 << 20).needed(),
      field("height_px", &S::height_px, "px", "rows").range(1, 1 << 20).needed(),
      field("pixel_m", &S::pixel_m, "m", "lcd: from pixel to pixel").positive(),
      field("world_from_screen", &S::world_from_screen, "", "its middle, x along its columns, z towards the viewer"),
      field("settle_s", &S::settle_s, "s", "from a new picture to a steady one").range(0, infinite)};
  return table;
}

const std::vector<Field<LaboratoryLimits>>& laboratory_limits_fields() {
  using L = LaboratoryLimits;
  static const std::vector<Field<L>> table{
      field("speed_m_per_s", &L::speed_m_per_s, "m/s", "of any tool").positive(),
      field("lower_m", &L::lower_m, "m", "corner of the box in the world that no tool leaves"),
      field("upper_m", &L::upper_m, "m", "its other corner"),
      field("margin_m", &L::margin_m, "m", "kept between any two solids; left out: 0.01").range(0, infinite),
      field("smallest_singular_m", &L::smallest_singular_m, "m",
            "kept by the smallest singular value of an arm's Jacobian; left out: 0.01")
          .range(0, infinite)};
  return table;
}

const std::vector<Field<Laboratory>>& laboratory_fields() {
  using L = Laboratory;
  static const std::vector<Field<L>> table{
      field("robots", &L::robots, "", "arms by name"),
      field("cameras", &L::cameras, "", "by their names in cameras, where their lenses stand"),
      field("lamps", &L::lamps, "", "by name"),
      field("turntables", &L::turntables, "", "by name"),
      field("screens", &L::screens, "", "by name"),
      field("obstacles", &L::obstacles, "", "what stands around: pedestal, table, walls, arc"),
      field("limits", &L::limits, "", "of the whole")};
  return table;
}

const std::vector<Field<PlanStep>>& plan_step_fields() {
  using S = PlanStep;
  static const std::vector<Field<S>> table{
      field("image", &S::image, "", "id of the picture that it makes").needed(),
      field("camera", &S::camera, "", "name in the laboratory's cameras"),
      field("purpose", &S::purpose, "", "what for").one_of({"view", "repeat", "reference", "dark", "board"}),
      field("lamps", &S::lamps, "", "that are on"),
      field("exposures_s", &S::exposures_s, "s", "one picture each").positive(),
      field("world_from_camera", &S::world_from_camera, "", "asked: takes camera to world coordinates"),
      field("roll_rad", &S::roll_rad, "rad",
            "asked: the camera may be turned about its axis by up to this, to either side; left out once joints are "
            "chosen, or where it may not")
          .range(0, 3.15),
      field("light_m", &S::light_m, "m", "asked: where the lamp that an arm holds is, world"),
      field("turntable_rad", &S::turntable_rad, "rad", "asked: angles by turntable"),
      field("screens", &S::screens, "", "what each shows: id of a pattern or a file"),
      field("projection", &S::projection, "", "name in projections, of which a screen shows a frame"),
      field("shows", &S::shows, "", "place in its frames, from 0").range(0, 1 << 16),
      field("group", &S::group, "", "view that its picture belongs to; left out: one of its own"),
      field("robot", &S::robot, "", "whose joints follow: the one that holds the camera"),
      field("joints_rad", &S::joints_rad, "rad", "where it stands at the photograph"),
      field("other_arms", &S::other_arms, "", "joints of the other arms, by robot [rad]"),
      field("via", &S::via, "", "joints of the arms on the way there, in order, by robot [rad]"),
      field("straight", &S::straight, "", "true: the camera follows a straight line there"),
      field("duration_s", &S::duration_s, "s", "of the motion there").range(0, infinite),
      field("smallest_singular_m", &S::smallest_singular_m, "m", "on the way there, of any arm").range(0, infinite),
      field("clearance_m", &S::clearance_m, "m", "on the way there, between any two solids")};
  return table;
}

const std::vector<Field<UnreachableView>>& unreachable_view_fields() {
  using U = UnreachableView;
  static const std::vector<Field<U>> table{
      field("image", &U::image, "", "id that was asked for").needed(), field("why", &U::why, "", "in words").needed(),
      field("world_from_camera", &U::world_from_camera, "", "asked: takes camera to world coordinates"),
      field("nearest", &U::nearest, "", "step that can be reached")};
  return table;
}

const std::vector<Field<MeasuredView>>& measured_view_fields() {
  using M = MeasuredView;
  static const std::vector<Field<M>> table{
      field("image", &M::image, "", "of the step").needed(), field("by", &M::by, "", "the program that found it"),
      field("world_from_camera", &M::world_from_camera, "", "takes camera to world coordinates").needed(),
      field("board", &M::board, "", "name of the board that was seen"),
      field("camera_from_board", &M::camera_from_board, "", "as it was seen, with its sigma")};
  return table;
}

const std::vector<Field<CheckView>>& check_view_fields() {
  using C = CheckView;
  static const std::vector<Field<C>> table{
      field("image", &C::image, "", "of the step").needed(),
      field("board", &C::board, "", "name of the board"),
      field("corners", &C::corners, "", "their numbers").range(0, 1 << 20),
      field("u_px", &C::u_px, "px", "of each"),
      field("v_px", &C::v_px, "px", "of each"),
      field("sigma_px", &C::sigma_px, "px", "of one coordinate of each").positive()};
  return table;
}

const std::vector<Field<Plan>>& plan_fields() {
  static const std::vector<Field<Plan>> table{
      field("id", &Plan::id, "", "SHA-256 of what decides it").needed(),
      field("pattern", &Plan::pattern, "", "what was asked, in words"),
      field("seed", &Plan::seed, "", "of the order's shuffle"),
      field("steps", &Plan::steps, "", "in the order in which they are taken").needed(),
      field("unreachable", &Plan::unreachable, "", "what was asked and cannot be"),
      field("figures", &Plan::figures, "", "of the whole, by name; the unit ends the name"),
      field("measured", &Plan::measured, "", "where cameras were found at its steps: later runs go by that"),
      field("checks", &Plan::checks, "", "the board as its first run saw it: what later runs are held against")};
  return table;
}

const std::vector<Field<Repeatability>>& repeatability_fields() {
  using R = Repeatability;
  static const std::vector<Field<R>> table{
      field("views", &R::views, "", "in which the board was found").range(0, infinite),
      field("position_m", &R::position_m, "m", "of one coordinate of the board's middle before the camera")
          .range(0, infinite),
      field("position_interval_m", &R::position_interval_m, "m", "[lower, upper] at 95 %").range(0, infinite),
      field("corners_m", &R::corners_m, "m", "what the corners' noise makes of it beside").range(0, infinite),
      field("rotation_rad", &R::rotation_rad, "rad", "about one axis").range(0, infinite),
      field("rotation_interval_rad", &R::rotation_interval_rad, "rad", "[lower, upper] at 95 %").range(0, infinite),
      field("corners_rad", &R::corners_rad, "rad", "what the corners' noise makes of it beside").range(0, infinite)};
  return table;
}

const std::vector<Field<DriftedFrames>>& drifted_frames_fields() {
  using D = DriftedFrames;
  static const std::vector<Field<D>> table{
      field("check", &D::check, "", "id of the view of the board that had moved").needed(),
      field("against", &D::against, "", "id of the view that it is held against"),
      field("value", &D::value, "", "how far, in `unit`; left out: no board was found").range(0, infinite),
      field("sigma", &D::sigma, "", "one standard deviation of it").range(0, infinite),
      field("limit", &D::limit, "", "that was given").range(0, infinite).needed(),
      field("unit", &D::unit, "", "m, rad or px").one_of({"m", "rad", "px"}).needed(),
      field("images", &D::images, "", "ids: taken between that view and the checks beside it")};
  return table;
}

const std::vector<Field<Run>>& run_fields() {
  static const std::vector<Field<Run>> table{
      field("plan", &Run::plan, "", "id of the plan").needed(),
      field("journal", &Run::journal, "", "file id"),
      field("frames", &Run::frames, "", "kept").range(0, infinite),
      field("retaken", &Run::retaken, "", "taken again after a disagreement").range(0, infinite),
      field("refused", &Run::refused, "", "given up after retakes").range(0, infinite),
      field("measured", &Run::measured, "", "frames that stand where the plan's `measured` says").range(0, infinite),
      field("repeatability", &Run::repeatability, "", "standard deviation over takes of the same views of a board"),
      field("drifted", &Run::drifted, "", "frames from a moved place: beyond the limit, with what shows it")};
  return table;
}

GONIO_RECORD(SolidBody, solid_body_fields);
GONIO_RECORD(JointLimits, joint_limits_fields);
GONIO_RECORD(CableSlack, cable_slack_fields);
GONIO_RECORD(LaboratoryRobot, laboratory_robot_fields);
GONIO_RECORD(LaboratoryCamera, laboratory_camera_fields);
GONIO_RECORD(LaboratoryLamp, laboratory_lamp_fields);
GONIO_RECORD(LaboratoryTurntable, laboratory_turntable_fields);
GONIO_RECORD(LaboratoryScreen, laboratory_screen_fields);
GONIO_RECORD(LaboratoryLimits, laboratory_limits_fields);
GONIO_RECORD(Laboratory, laboratory_fields);
GONIO_RECORD(PlanStep, plan_step_fields);
GONIO_RECORD(UnreachableView, unreachable_view_fields);
GONIO_RECORD(MeasuredView, measured_view_fields);
GONIO_RECORD(CheckView, check_view_fields);
GONIO_RECORD(Plan, plan_fields);
GONIO_RECORD(Repeatability, repeatability_fields);
GONIO_RECORD(DriftedFrames, drifted_frames_fields);
GONIO_RECORD(Run, run_fields);

}  // namespace gonio::manifest
