// Board corners as a problem for the engine. Observations: u and v of every detected corner (px), one group per board
// view, one block per corner. Free in the base model: the intrinsics and lens terms which the camera section gives, the
// board's warp where its section gives one, the terms that the manifest's "mechanisms" switch on, and six numbers of
// pose for every view as its nuisance. Intrinsics that other views have calibrated (the section says "held") keep to
// what they said. Hypotheses: every mechanism of the registry for "boards" which the base model
// lacks and the table can show; a parameter is found in the forward model by its name.
//
// Views of one camera and one board that state the same camera_from_board, to the last digit, and whose corners lie
// together, are of a fixed target: they share one pose.
//
// Frames: board (x along columns, y down the rows, z away from the viewer), camera (x right, y down, z forward);
// metres, pixels. The forward model is camera/corner_model.h, which is calib-charuco's where nothing is added.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "camera/corner_model.h"
#include "explain/boards/print_places.h"
#include "explain/domain.h"
#include "explain/engine.h"

namespace gonio::explain {

struct BoardsInput {
  struct Camera {
    std::string name;
    camera::Intrinsics intrinsics;
    int width_px = 0, height_px = 0;
    std::vector<std::size_t> terms;  // of camera::distortion_names which the base model has
    // Calibrated on other views: fx, fy, cx, cy and the lens terms have these standard errors, and stay within four.
    bool held = false;
    std::array<double, 4 + camera::distortion_terms> sigma{};
  };
  struct Board {
    std::string name;
    double square_m = 0;
    camera::BoardExtent extent;
    camera::BoardWarp warp;
    bool warped = false;  // the base model has the warp already
    // Places, in whole squares, of the corners that enough views show for board.print to speak of them: settle_views().
    std::vector<std::array<long, 2>> places{};
    PrintPlaces print{};
  };
  struct Corner {
    Vec2 board_m, pixel;
    double sigma_px = 0;
    camera::Colour colour = camera::Colour::green;
    double turned_rad = 0;
    std::size_t of_board = static_cast<std::size_t>(-1);  // in Board::places; the largest number: none of them
  };
  struct View {
    std::string image;
    std::size_t camera = 0, board = 0;
    camera::BoardPose camera_from_board;
    std::vector<Corner> corners;
    std::optional<double> time_s{}, temperature_K{};
    std::size_t pose_of = 0;           // the first view that has this pose; for most views their own place
    double warmer_K = 0, later_s = 0;  // than the mean of the views, where all of them say
  };
  struct Given {                // a term that the base model has by the manifest's "mechanisms"
    std::string mechanism, on;  // of which camera, board or image
    std::size_t column = 0;     // camera::CornerColumn
    double value = 0;
    std::optional<std::array<long, 2>> place{};  // of the corner, in whole squares
    std::optional<std::size_t> view{};           // whose own number it is
  };
  std::vector<Camera> cameras;
  std::vector<Board> boards;
  std::vector<View> views;
  std::vector<Given> given{};
};

// Corner tables (model "camera") with their cameras, boards and images. Error(data) in words where one of them is
// missing, or where there are fewer than three views.
bool has_boards(const manifest::Document& document);
BoardsInput boards_input(const manifest::Document& document);

// Fills pose_of, warmer_K and later_s from what the views state, and which corners are whose.
void settle_views(BoardsInput& input);

std::unique_ptr<Problem> boards_problem(BoardsInput input);
// Of such a problem: what its fit says against a candidate that it has named (Domain::objects).
std::optional<Testimony> boards_objection(const Problem& problem, const Explanation& explanation,
                                          std::size_t candidate);

}  // namespace gonio::explain
