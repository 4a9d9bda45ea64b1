// The forward model of calibration boards with its derivatives, in plain doubles: predicted pixel of one board point,
// and the Jacobian with respect to everything that calibration or explain may free. Frames and the warp's equation:
// board_terms.h.
#pragma once
#include <array>
#include <cstddef>
#include <string_view>

#include "camera/board_terms.h"
#include "camera/intrinsics.h"
#include "geom/rigid.h"

namespace gonio::camera {

// Columns of the Jacobian. A change of pose turns the board by a small rotation vector applied on the left, about the
// camera's axes through the board's origin, R <- exp([w]x) R, and shifts it, t <- t + dt: the convention of
// manifest::PoseSigma.
struct BoardColumn {
  static constexpr std::size_t intrinsics = 0;                            // as pinhole_names
  static constexpr std::size_t distortion = 4;                            // as distortion_names
  static constexpr std::size_t rotation = distortion + distortion_terms;  // x y z, rad
  static constexpr std::size_t translation = rotation + 3;                // x y z, m
  static constexpr std::size_t warp = translation + 3;                    // sag_x_m sag_y_m
  static constexpr std::size_t count = warp + 2;
};

inline constexpr std::array<std::string_view, 4> pinhole_names = {"fx_px", "fy_px", "cx_px", "cy_px"};

using BoardPose = Rigid<frame::Camera, frame::Board>;

struct BoardWarp {
  double sag_x_m = 0, sag_y_m = 0;
};

// The pose moved by [rotation vector (3, rad), shift (3, m)] in the sense of the Jacobian's columns.
BoardPose moved(const BoardPose& pose, const std::array<double, 6>& change);

// False for points that the lens does not show (behind a perspective camera), where `pixel` is left alone.
bool predict(const Intrinsics& intrinsics, const BoardPose& camera_from_board, const BoardExtent& extent,
             const BoardWarp& warp, Vec2 board_point_m, Vec2& pixel);

// The same with derivatives; jacobian[0] belongs to u, [1] to v.
bool predict(const Intrinsics& intrinsics, const BoardPose& camera_from_board, const BoardExtent& extent,
             const BoardWarp& warp, Vec2 board_point_m, Vec2& pixel,
             std::array<std::array<double, BoardColumn::count>, 2>& jacobian);

}  // namespace gonio::camera
