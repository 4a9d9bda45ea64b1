// handeye: how a camera is mounted on a robot, or stands before it, from images of a board at poses of the robot.
#include "base/atomic_file.h"
#include "base/progress.h"
#include "cli/common_options.h"
#include "robot/handeye/closed_forms.h"
#include "robot/light_handeye.h"
#include "robot/pose_list.h"
#include "tools/handeye/page.h"

namespace gonio::tools::handeye {
namespace {

using namespace gonio::robot;
using cli::Type;

std::vector<std::string> methods() {
  std::vector<std::string> names{"joint"};
  for (const auto& form : robot::handeye::closed_forms()) names.emplace_back(form.name);
  return names;
}

std::string convention_names() {
  std::string names;
  for (const auto& c : pose_conventions()) names += (names.empty() ? "" : ", ") + c.name;
  return names;
}

std::vector<cli::Option> options() {
  return {
      {.name = "kind",
       .type = Type::choice,
       .help = "Where the camera sits: on the tool, or beside the robot with the board on the tool.",
       .preset = "eye-in-hand",
       .choices = {"eye-in-hand", "eye-to-hand"}},
      {.name = "method",
       .type = Type::choice,
       .help = "What is written: the joint refinement, or a closed form by name.",
       .preset = "joint",
       .choices = methods()},
      {.name = "poses",
       .type = Type::input_file,
       .help = "Poses of the robot, one per image in their order: a list, or one file per pose.",
       .repeat = true,
       .needs = {"pose-format"}},
      {.name = "pose-format",
       .type = Type::text,
       .help = "Convention of the poses: " + convention_names() + ", euler-ABC, fixed-ABC.",
       .metavar = "NAME"},
      {.name = "pose-length",
       .type = Type::choice,
       .help = "Unit of lengths instead of the convention's own.",
       .choices = {"m", "cm", "mm"},
       .needs = {"pose-format"}},
      {.name = "pose-angle",
       .type = Type::choice,
       .help = "Unit of angles instead of the convention's own.",
       .choices = {"rad", "deg"},
       .needs = {"pose-format"}},
      {.name = "pose-direction",
       .type = Type::choice,
       .help = "What the poses take where.",
       .preset = "base_from_tool",
       .choices = {"base_from_tool", "tool_from_base"}},
      {.name = "match",
       .type = Type::choice,
       .help = "How poses find their images: in order, or by their names.",
       .preset = "order",
       .choices = {"order", "name"}},
      {.name = "camera",
       .type = Type::text,
       .help = "Which camera, where the manifest has several.",
       .metavar = "NAME"},
      {.name = "board", .type = Type::text, .help = "Which board, where the manifest has several.", .metavar = "NAME"},
      {.name = "robot", .type = Type::text, .help = "Which robot: images of others are left out.", .metavar = "NAME"},
      {.name = "table", .type = Type::text, .help = "Table of the corners.", .metavar = "NAME", .preset = "corners"},
      {.name = "light",
       .type = Type::flag,
       .help = "Find a light on the tool, and the robot's base in the world, from light_positions instead.",
       .conflicts = {"kind", "method", "poses", "camera", "board", "table", "max-error"}},
      {.name = "light-name",
       .type = Type::text,
       .help = "Which light, where light_positions has several.",
       .metavar = "NAME",
       .needs = {"light"}},
      {.name = "max-error",
       .type = Type::quantity,
       .help = "Exit 2 where the board lies farther off than this at 95 %, at a pose not seen.",
       .dimension = Dimension::length,
       .lower = 0},
      cli::report_option()};
}

void read_poses(cli::Invocation& call) {
  if (call.given("POSE") && call.given("poses"))
    throw Error(Exit::usage, "--poses", "cannot stand beside POSE operands", "give one of them");
  const std::string source = call.given("POSE") ? "POSE" : "poses";
  if (!call.given(source)) return;
  if (!call.given("pose-format"))
    throw Error(Exit::usage, call.texts(source).front(), "what its numbers mean is not said",
                "name it: --pose-format ur");
  const auto optional = [&](const char* name) { return call.given(name) ? call.text(name) : std::string(); };
  const PoseListFormat format = pose_list_format(call.text("pose-format"), optional("pose-length"),
                                                 optional("pose-angle"), call.text("pose-direction"), "--pose-format");
  const std::vector<std::filesystem::path> files(call.texts(source).begin(), call.texts(source).end());
  for (const auto& file : files) call.note_input(file);
  const PoseList list = files.size() == 1 ? read_pose_list(files.front(), format) : read_pose_files(files, format);
  for (const std::string& warning : list.warnings) log(LogLevel::warning, warning);
  enter_poses(list, call.text("match") == "name", call.document);
}

HandEyeRequest request_of(const cli::Invocation& call) {
  HandEyeRequest request;
  if (call.text("kind") == "eye-to-hand") request.kind = robot::handeye::Kind::eye_to_hand;
  request.method = call.text("method");
  request.table = call.text("table");
  if (call.given("camera")) request.camera = call.text("camera");
  if (call.given("board")) request.board = call.text("board");
  if (call.given("robot")) request.robot = call.text("robot");
  return request;
}

void write_page(cli::Invocation& call, const std::string& html) {
  std::vector<std::filesystem::path> files;
  if (call.given("html")) files.emplace_back(call.text("html"));
  if (!call.out.empty()) files.push_back(call.output_path("handeye.html"));
  for (const auto& file : files) {
    write_file(file, html);
    manifest::add_file(call.document, file, "handeye-report");
  }
}

Exit calibrate_lamp(cli::Invocation& call) {
  std::string light = call.given("light-name") ? call.text("light-name") : "";
  const std::string robot = call.given("robot") ? call.text("robot") : "";
  const auto samples = light_samples(call.document, light, robot);
  const LightMounting mounting = calibrate_light(samples);
  enter_light_mounting(mounting, light, robot, call.document);
  write_page(call, light_page(mounting, samples, light));
  for (const std::string& open : mounting.unobservable) log(LogLevel::error, "not determined by these poses: " + open);
  return mounting.unobservable.empty() ? Exit::done : Exit::quality;
}

Exit calibrate(cli::Invocation& call) {
  if (call.flag("light")) return calibrate_lamp(call);
  const HandEyeRequest request = request_of(call);
  const HandEyeInput input = handeye_input(call.document, request);
  for (const std::string& image : input.left_out) log(LogLevel::warning, image + ": left out");
  auto analysis = robot::handeye::analyse(input.setup, input.views, request.method);
  if (const auto within = analysis.within_m();
      call.given("max-error") && within && *within > call.number("max-error")) {
    analysis.complaints.push_back("the board lies within " + std::to_string(*within * 1e3) +
                                  " mm at 95 %, more than --max-error");
  }
  enter_mounting(input, request, analysis, call.document);
  write_page(call, handeye_page(input, analysis));
  for (const std::string& line : outlier_lines(input, analysis)) log(LogLevel::warning, line);
  for (const std::string& line : summary_of(input, analysis)) log(LogLevel::info, line);
  for (const std::string& line : analysis.next) log(LogLevel::info, "add: " + line);
  for (const std::string& complaint : analysis.complaints) log(LogLevel::error, complaint);
  return analysis.complaints.empty() ? Exit::done : Exit::quality;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "handeye",
      .sentence = "find how a camera is mounted on a robot or stands before it",
      .synopsis = {"[OPTION]... [manifest.json]", "--pose-format NAME [OPTION]... [manifest.json] POSE...",
                   "--light [OPTION]... [manifest.json]"},
      .options = options(),
      .operands = {{.name = "POSE",
                    .type = Type::input_file,
                    .help = "Poses of the robot as for --poses; what ends in .json is the manifest.",
                    .repeat = true}},
      .reads = cli::Reads::required,
      .takes_out = true,
      .sections_read = {"boards", "cameras", "images", "tables", "light_positions", "plans", "runs"},
      .sections_written = {"files", "frames", "images", "mountings", "plans"},
      .files = {{"handeye.html", "the report"}},
      .exits =
          {{Exit::quality,
            "The mountings are written, but the poses do not determine them (what they leave open is named and left "
            "out), too many are outliers, they fit better inverted, or --max-error is exceeded."}},
      .references =
          {"R. Tsai, R. Lenz, A new technique for fully autonomous and efficient 3D robotics hand/eye calibration, "
           "IEEE T-RA 5(3), 1989.",
           "F. Park, B. Martin, Robot sensor calibration: solving AX = XB on the Euclidean group, IEEE T-RA 10(5), "
           "1994.",
           "K. Daniilidis, Hand-eye calibration using dual quaternions, IJRR 18(3), 1999.",
           "M. Shah, Solving the robot-world/hand-eye calibration problem using the Kronecker product, J. Mechanisms "
           "and Robotics 5(3), 2013.",
           "H. Patterson, R. Thompson, Recovery of inter-block information when block sizes are unequal, "
           "Biometrika 58, 1971."},
      .see_also = {"calib-charuco(1)", "explain(1)", "gonio-manifest(5)", "gonio-conventions(7)"},
      .check =
          [](cli::Invocation& call) {
            std::string light = call.given("light-name") ? call.text("light-name") : "";
            if (call.flag("light")) {
              light_samples(call.document, light, call.given("robot") ? call.text("robot") : "");
              return;
            }
            read_poses(call);
            handeye_input(call.document, request_of(call));
          },
      .run = calibrate};
  return program;
}

}  // namespace gonio::tools::handeye
