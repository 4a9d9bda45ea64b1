// calib-charuco: photographs of a calibration board to a calibrated camera (camera/calibrate_document.h), or a board to print.
#include "camera/board_drawing.h"
#include "camera/calibrate_document.h"
#include "camera/marker_dictionary.h"
#include "cli/program.h"

namespace gonio::tools::calib_charuco {
namespace {

using cli::Type;

bool describes_board(const cli::Invocation& call) { return call.given("checkerboard") || call.given("charuco"); }

camera::Board board_of(const cli::Invocation& call) {
  const bool charuco = call.given("charuco");
  const std::string option = charuco ? "charuco" : "checkerboard";
  manifest::Board section;
  section.kind = option;
  (charuco ? section.squares : section.inner_corners) = camera::columns_and_rows(call.text(option), "--" + option);
  section.square_m = call.number("square");
  if (charuco) {
    section.marker_m = call.number("marker");
    section.dictionary = call.text("dictionary");
    if (call.text("layout") != "auto") section.legacy_layout = call.text("layout") == "legacy";
  }
  try {
    return camera::board_of(section, "--" + option);
  } catch (const Error& e) {
    throw Error(Exit::usage, e.place(), e.problem(), e.remedy());
  }
}

camera::CalibrationRequest request_of(cli::Invocation& call) {
  camera::CalibrationRequest request;
  request.calibration.model = call.text("model");
  request.model_given = call.given("model") || !call.has_document;
  request.calibration.board_warp = call.flag("board-warp");
  for (const std::string& term : call.texts("fix")) request.calibration.fixed.insert(term);
  if (call.given("refine-window")) request.detection.window_px = static_cast<int>(call.integer("refine-window"));
  if (!call.out.empty()) request.corners_csv = call.output_path("corners.csv");
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

void check(cli::Invocation& call) {
  if (call.given("draw")) {
    if (!describes_board(call)) throw Error(Exit::usage, "--draw", "has no board", "add --checkerboard or --charuco");
    if (call.given("IMAGE")) throw Error(Exit::usage, "--draw", "cannot stand beside photographs", "draw first, then calibrate");
    camera::check_drawing_name(call.text("draw"));
    camera::lay_out(board_of(call), call.text("paper"), "--paper");
    return;
  }
  if (!call.has_document) {
    call.document.name = "command line";
    if (!describes_board(call)) {
      throw Error(Exit::usage, "calib-charuco", "has no board", "add --checkerboard 9x6 --square 25mm, or a manifest with boards");
    }
    if (!call.given("IMAGE")) throw Error(Exit::usage, "IMAGE", "is missing", "name photographs of the board");
  }
  if (describes_board(call)) {
    if (!call.document.boards.empty()) {
      throw Error(Exit::usage, call.given("charuco") ? "--charuco" : "--checkerboard", "the manifest describes its boards already",
                  "leave the option out");
    }
    camera::enter_board(board_of(call), call.document);
  }
  if (call.given("IMAGE")) {
    call.document.allow_outside = true;  // what the user names may lie anywhere
    camera::enter_pictures(call.texts("IMAGE"), call.text("model"), call.document);
  }
  camera::check_calibration(call.document);
}

Exit run(cli::Invocation& call) {
  if (call.given("draw")) {
    camera::draw_board(board_of(call), call.text("draw"), call.text("paper"), call.number("dpi"));
    if (!call.document.boards.contains("board")) camera::enter_board(board_of(call), call.document);
    return Exit::done;
  }
  return camera::calibrate_document(call.document, request_of(call));
}

std::vector<std::string> paper_names() {
  std::vector<std::string> names;
  for (const camera::Paper& paper : camera::papers()) names.emplace_back(paper.name);
  return names;
}

std::vector<cli::Option> options() {
  return {
      {.name = "checkerboard", .type = Type::text, .help = "Plain board: columns and rows of inner corners.", .metavar = "CxR",
       .conflicts = {"charuco"}, .needs = {"square"}},
      {.name = "charuco", .type = Type::text, .help = "ChArUco board: columns and rows of squares.", .metavar = "CxR",
       .needs = {"square", "marker", "dictionary"}},
      {.name = "square", .type = Type::quantity, .help = "Side of a square.", .dimension = Dimension::length, .lower = 1e-6,
       .upper = 10},
      {.name = "marker", .type = Type::quantity, .help = "Side of a marker with its black border.",
       .dimension = Dimension::length, .lower = 1e-6, .upper = 10, .needs = {"charuco"}},
      {.name = "dictionary", .type = Type::text, .help = "Dictionary of the markers: 4X4_50 to 7X7_1000, ARUCO_ORIGINAL.",
       .metavar = "NAME", .needs = {"charuco"}},
      {.name = "layout", .type = Type::choice,
       .help = "Layout of a ChArUco board with an even number of rows: legacy is that of OpenCV before 4.6.", .preset = "auto",
       .choices = {"auto", "current", "legacy"}, .needs = {"charuco"}},
      {.name = "model", .type = Type::choice, .help = "Lens model; a camera in the manifest keeps its own unless this is given.",
       .preset = "radial-tangential", .choices = camera::calibrated_models()},
      {.name = "fix", .type = Type::choice,
       .help = "Hold a term: at the manifest's value, else at 0, equal focal lengths, the middle of the picture.",
       .choices = camera::fixable_terms(), .repeat = true},
      {.name = "board-warp", .type = Type::flag, .help = "Also fit how far the board sags (two parameters)."},
      {.name = "refine-window", .type = Type::integer,
       .help = "Half-window of corner refinement in pixels instead of the one that follows the squares.", .metavar = "N",
       .lower = 1, .upper = 50},
      {.name = "draw", .type = Type::output_file,
       .help = "Print the board at true scale to a .pdf, .svg or .png instead of calibrating."},
      {.name = "paper", .type = Type::choice, .help = "Paper to draw on; fit: as large as the board and a margin.",
       .preset = "a4", .choices = paper_names(), .needs = {"draw"}},
      {.name = "dpi", .type = Type::number, .help = "Dots per inch of a .png drawing.", .preset = "300", .lower = 10,
       .upper = 4800, .needs = {"draw"}}};
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "calib-charuco",
      .sentence = "calibrate a camera from photographs of a checkerboard or ChArUco board",
      .synopsis = {"--checkerboard CxR --square LENGTH [OPTION]... IMAGE...",
                   "--charuco CxR --square LENGTH --marker LENGTH --dictionary NAME [OPTION]... IMAGE...",
                   "[-i FILE] [OPTION]...", "--draw FILE --charuco CxR --square LENGTH ..."},
      .options = options(),
      .operands = {{.name = "IMAGE", .type = Type::input_file, .help = "Photographs of the board, from different directions.",
                    .repeat = true}},
      .standalone = {"draw"}, .takes_out = true,
      .sections_read = {"files", "boards", "cameras", "images"},
      .sections_written = {"files", "boards", "cameras", "images", "tables"},
      .files = {{"corners.csv", "found corners: image, corner, board and pixel coordinates, sigma"}},
      .exits = {{Exit::quality, "The camera is written, but the fit did not converge, the views are too few or too frontal, or corners "
                                "miss by more than 3 px."}},
      .references = {"Z. Zhang, A flexible new technique for camera calibration, PAMI 22(11), 2000.",
                     "D. C. Brown, Close-range camera calibration, Photogrammetric Engineering 37(8), 1971.",
                     "S. Garrido-Jurado et al., Automatic generation and detection of highly reliable fiducial markers, Pattern "
                     "Recognition 47(6), 2014.",
                     "T. Collins, A. Bartoli, Infinitesimal plane-based pose estimation, IJCV 109(3), 2014."},
      .see_also = {"explain(1)", "render(1)", "gonio-manifest(5)", "gonio-conventions(7)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::calib_charuco
