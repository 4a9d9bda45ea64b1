// Where a corner of a calibration board is found: the board's projection (board_projection.h) with every optional term
// that a table of corners can show. Frames: board (x along columns, y down the rows), camera (x right, y down, z
// forward); metres, pixels, radians.
//
//   board.shape             (x, y, z) += sum of coefficient P_i P_j over the printed place
//                           (camera/mechanisms/board_shape.h)
//   board.print             (x, y, z) += numbers of the corner that is asked for: whoever asks sets them
//   board.scale             (x, y) -> ((1 + scale_x) x, (1 + scale_y) y) on the board; the warp's height at that place
//   camera.rolling-shutter  the board stands at t + tau (motion_x_m, motion_y_m, 0) when row v is read,
//                           tau = (v - (h - 1) / 2) / h; v solves v = P_v(t + tau(v) m) (Oth, Furgale, Kneip &
//                           Siegwart, CVPR 2013, constant velocity within one image)
//   lens.non-central        the ray at the angle theta from the axis passes through (0, 0, s), s = pupil_m sin^2 theta,
//                           so that (X, Y, Z) is seen as (X, Y, Z - s) by a central lens (moving entrance pupil,
//                           Gennery, IJCV 68(3), 2006, to first order in theta^2)
//   camera.flat-port        (X, Y, Z) is seen where its ray leaves a plane before the lens, refracted there
//                           (camera/mechanisms/camera_flat_port.h); the lens sees that place
//   lens.lateral-colour     (x', y') of lens_terms.h times 1 + linear + cubic r'^2, r' = |(x', y')|, with numbers of
//                           their own for red and blue; green is the reference
//   camera.thermal          fx, fy times 1 + focal_per_K dT + focal_per_s dt, and cx, cy shifted by the x_px, y_px
//                           rates, dT and dt counted from the mean of the recordings
//   camera.focal-length     fx, fy times 1 + relative, beside what camera.thermal does
//   board.corner-bias       (u, v) += R(turned) bias_px, `turned` the angle by which the picture was turned before its
//                           corners were sought
//
// Everything is one vector of numbers, named as the mechanisms name their parameters: whoever knows a parameter's name
// finds its column. Invariant: at the neutral values (all zero, an index of one) the prediction is bit-identical to
// that of camera::predict.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "camera/board_projection.h"

namespace gonio::camera {

struct CornerColumn {                                         // continues BoardColumn
  static constexpr std::size_t motion = BoardColumn::count;   // x, y: m per readout
  static constexpr std::size_t scale = motion + 2;            // x, y
  static constexpr std::size_t pupil = scale + 2;             // m
  static constexpr std::size_t colour = pupil + 1;            // red linear, red cubic, blue linear, blue cubic
  static constexpr std::size_t bias = colour + 4;             // x, y: px
  static constexpr std::size_t by_temperature = bias + 2;     // focal, x, y: 1/K, px/K
  static constexpr std::size_t by_time = by_temperature + 3;  // focal, x, y: 1/s, px/s
  static constexpr std::size_t port = by_time + 3;            // index, distance: m, tilt x, tilt y: rad
  static constexpr std::size_t focal = port + 4;              // relative change of fx and fy
  static constexpr std::size_t shape = focal + 1;             // as equation::board_shape_terms: m
  static constexpr std::size_t print = shape + 26;            // of the corner that is asked for: x, y, z: m
  static constexpr std::size_t count = print + 3;
  static constexpr bool is_motion(std::size_t column) { return column >= motion && column < scale; }
};
inline constexpr std::array<std::string_view, 3> print_names = {"x_m", "y_m", "z_m"};  // from CornerColumn::print on

constexpr std::array<double, CornerColumn::count> neutral_corner_values() {
  std::array<double, CornerColumn::count> values{};
  values[CornerColumn::port] = 1;
  return values;
}

// Column of a parameter by its name in the mechanisms' declarations ("k1", "sag_x_m", "pupil_m"); nothing for others.
std::optional<std::size_t> corner_column(std::string_view parameter);

struct CornerModel {                                                         // of one view
  std::array<double, CornerColumn::count> values = neutral_corner_values();  // those of the pose are not read
  BoardPose pose;
  BoardExtent extent;
  int height_px = 0;
  double warmer_K = 0, later_s = 0;  // than the mean of the recordings
};
enum class Colour { red, green, blue };
struct CornerPlace {
  Vec2 board_m;
  Colour colour = Colour::green;
  double turned_rad = 0;
};
using CornerJacobian = std::array<std::array<double, CornerColumn::count>, 2>;  // of u and v

// False for points that the lens does not show, and for motions faster than the readout; `pixel` is then undefined.
bool predict(const CornerModel& model, const CornerPlace& place, Vec2& pixel);
bool predict(const CornerModel& model, const CornerPlace& place, Vec2& pixel, CornerJacobian& jacobian);

}  // namespace gonio::camera
