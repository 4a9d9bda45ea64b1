// calib-charuco: photographs of a calibration board to a calibrated camera (camera/calibrate_document.h), or a board to
// print.
#include "cli/program.h"

#include "camera/board_drawing.h"
#include "cli/board_options.h"
#include "manifest/sections/board.h"
#include "tools/calib-charuco/options.h"

namespace gonio::tools::calib_charuco {
namespace {

using cli::Type;

void check(cli::Invocation& call) {
  if (call.given("draw")) {
    if (!cli::describes_board(call))
      throw Error(Exit::usage, "--draw", "has no board", "add --checkerboard or --charuco");
    if (call.given("IMAGE"))
      throw Error(Exit::usage, "--draw", "cannot stand beside photographs", "draw first, then calibrate");
    camera::check_drawing_name(call.text("draw"));
    camera::lay_out(cli::board_of(call), call.text("paper"), "--paper");
    return;
  }
  enter_command_line(call);
  camera::check_calibration(call.document, call.given("projector"));
}

Exit run(cli::Invocation& call) {
  if (call.given("draw")) {
    camera::draw_board(cli::board_of(call), call.text("draw"), call.text("paper"), call.number("dpi"));
    if (!call.document.boards.contains("board")) camera::enter_board(cli::board_of(call), call.document);
    return Exit::done;
  }
  return camera::calibrate_document(call.document, request_of(call));
}

std::vector<cli::Option> options() {
  std::vector<cli::Option> list = calibration_options();
  const std::vector<cli::Option> drawing = {
      {.name = "draw",
       .type = Type::output_file,
       .help = "Print the board at true scale to a .pdf, .svg or .png instead of calibrating."},
      {.name = "paper",
       .type = Type::choice,
       .help = "Paper to draw on; fit: as large as the board and a margin.",
       .preset = "a4",
       .choices = camera::paper_names(),
       .needs = {"draw"}},
      {.name = "dpi",
       .type = Type::number,
       .help = "Dots per inch of a .png drawing.",
       .preset = "300",
       .lower = 10,
       .upper = 4800,
       .needs = {"draw"}}};
  list.insert(list.end(), drawing.begin(), drawing.end());
  return list;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "calib-charuco",
      .sentence = "calibrate a camera from photographs of a checkerboard or ChArUco board",
      .synopsis = {"--checkerboard CxR --square LENGTH [OPTION]... IMAGE...",
                   "--charuco CxR --square LENGTH --marker LENGTH --dictionary NAME [OPTION]... IMAGE...",
                   "[-i FILE] [OPTION]...", "--projector NAME -i shown.json [OPTION]... [VIEW/IMAGE]...",
                   "--draw FILE --charuco CxR --square LENGTH ..."},
      .options = options(),
      .operands = {{.name = "IMAGE",
                    .type = Type::input_file,
                    .help = "Photographs of the board, from different directions.",
                    .repeat = true}},
      .standalone = {"draw"},
      .takes_out = true,
      .sections_read = {"files", "boards", "cameras", "images", "mechanisms", "plans", "projections", "runs"},
      .sections_written = {"files", "boards", "cameras", "rigs", "images", "tables", "plans"},
      .files = {{"corners.csv", "found corners: image, corner, board and pixel coordinates, sigma"},
                {"calibration.html",
                 "one self-contained page: how good it is, residuals, views, what to photograph next"},
                {"projection-sigma*.exr, .png", "projection uncertainty over the image, one at each distance"},
                {"coverage.png", "how many views reach each part of the image"}},
      .exits =
          {{Exit::quality,
            "The camera is written, but the fit did not converge, the views are too few or too frontal to know the "
            "focal length to 1 %, corners miss by more than 3 px, or calibrations of either half of the views "
            "differ by more than their uncertainty."}},
      .references =
          {"Z. Zhang, A flexible new technique for camera calibration, PAMI 22(11), 2000.",
           "D. C. Brown, Close-range camera calibration, Photogrammetric Engineering 37(8), 1971.",
           "S. Garrido-Jurado et al., Automatic generation and detection of highly reliable fiducial markers, Pattern "
           "Recognition 47(6), 2014.",
           "D. Kogan, mrcal: camera calibrations and more, 2021, on the uncertainty of projection.",
           "D. Moreno, G. Taubin, Simple, accurate, and robust projector-camera calibration, 3DIMPVT 2012.",
           "T. Collins, A. Bartoli, Infinitesimal plane-based pose estimation, IJCV 109(3), 2014."},
      .see_also = {"structured-light(1)", "explain(1)", "render(1)", "gonio-manifest(5)", "gonio-conventions(7)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::calib_charuco
