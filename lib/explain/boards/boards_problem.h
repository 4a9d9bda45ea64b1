// Board corners as a problem for the engine. Observations: u and v of every detected corner (px), one group per board
// view, one block per corner. Free in the base model: the intrinsics and lens terms which the camera section gives, and
// six numbers of pose for every view as its nuisance. Hypotheses: lens terms that the camera section lacks, and the
// board's warp.
//
// Frames: board (x along columns, y down the rows, z away from the viewer), camera (x right, y down, z forward);
// metres, pixels. The forward model is camera/board_projection.h: what calib-charuco fits is what is explained here.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "camera/board_projection.h"
#include "explain/problem.h"

namespace gonio::explain {

struct BoardsInput {
  struct Camera {
    std::string name;
    camera::Intrinsics intrinsics;
    int width_px = 0, height_px = 0;
    std::vector<std::size_t> terms;  // of camera::distortion_names which the base model has
  };
  struct Board {
    std::string name;
    double square_m = 0;
    camera::BoardExtent extent;
    camera::BoardWarp warp;
    bool warped = false;  // the base model has the warp already
  };
  struct Corner {
    Vec2 board_m, pixel;
    double sigma_px = 0;
  };
  struct View {
    std::string image;
    std::size_t camera = 0, board = 0;
    camera::BoardPose camera_from_board;
    std::vector<Corner> corners;
  };
  std::vector<Camera> cameras;
  std::vector<Board> boards;
  std::vector<View> views;
};

// Corner tables (model "camera") with their cameras, boards and images. Error(data) in words where one of them is
// missing, or where there are fewer than three views.
bool has_boards(const manifest::Document& document);
BoardsInput boards_input(const manifest::Document& document);

std::unique_ptr<Problem> boards_problem(BoardsInput input);

}  // namespace gonio::explain
