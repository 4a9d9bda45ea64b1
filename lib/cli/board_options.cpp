// See board_options.h.
#include "cli/board_options.h"

#include "base/error.h"
#include "camera/calibrate_document.h"
#include "manifest/sections/board.h"

namespace gonio::cli {

bool describes_board(const Invocation& call) {
  return call.given("checkerboard") || call.given("charuco");
}

camera::Board board_of(const Invocation& call) {
  const bool charuco = call.given("charuco");
  const std::string option = charuco ? "charuco" : "checkerboard";
  manifest::Board section;
  section.kind = option;
  (charuco ? section.squares : section.inner_corners) = camera::columns_and_rows(call.text(option), "--" + option);
  section.square_m = call.number("square");
  if (charuco) {
    section.marker_m = call.number("marker");
    if (call.given("dictionary")) section.dictionary = call.text("dictionary");
    if (call.text("layout") != "auto") section.legacy_layout = call.text("layout") == "legacy";
  }
  try {
    return camera::board_of(section, "--" + option, call.given("dictionary-file") ? call.text("dictionary-file") : "");
  } catch (const Error& e) {
    if (!e.place().starts_with("--")) throw;
    throw Error(Exit::usage, e.place(), e.problem(), e.remedy());
  }
}

void enter_described_board(Invocation& call) {
  if (!call.document.boards.empty())
    throw Error(Exit::usage, call.given("charuco") ? "--charuco" : "--checkerboard",
                "the manifest describes its boards already", "leave the option out");
  camera::enter_board(board_of(call), call.document);
}

std::vector<Option> board_options() {
  return {{.name = "checkerboard",
           .type = Type::text,
           .help = "Plain board: columns and rows of inner corners.",
           .metavar = "CxR",
           .conflicts = {"charuco"},
           .needs = {"square"}},
          {.name = "charuco",
           .type = Type::text,
           .help = "ChArUco board: columns and rows of squares.",
           .metavar = "CxR",
           .needs = {"square", "marker"}},
          {.name = "square",
           .type = Type::quantity,
           .help = "Side of a square.",
           .dimension = Dimension::length,
           .lower = 1e-6,
           .upper = 10},
          {.name = "marker",
           .type = Type::quantity,
           .help = "Side of a marker with its black border.",
           .dimension = Dimension::length,
           .lower = 1e-6,
           .upper = 10,
           .needs = {"charuco"}},
          {.name = "dictionary",
           .type = Type::text,
           .help = "Dictionary of the markers: 4X4_50 to 7X7_1000, ARUCO_ORIGINAL.",
           .metavar = "NAME",
           .conflicts = {"dictionary-file"},
           .needs = {"charuco"}},
          {.name = "dictionary-file",
           .type = Type::input_file,
           .help = "Dictionary of one's own, in OpenCV's YAML or JSON.",
           .needs = {"charuco"}},
          {.name = "layout",
           .type = Type::choice,
           .help = "Layout of a ChArUco board with an even number of rows: legacy is that of OpenCV before 4.6.",
           .preset = "auto",
           .choices = {"auto", "current", "legacy"},
           .needs = {"charuco"}}};
}

}  // namespace gonio::cli
