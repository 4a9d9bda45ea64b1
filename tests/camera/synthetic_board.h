// Photographs of boards whose corners are known: every pixel is the mean of the printed pattern over its square, 8 x 8
// samples in stratified places, seen by a pinhole; and poses that look at the board from all around.
#pragma once
#include <cmath>
#include <utility>
#include <vector>

#include "base/random.h"
#include "camera/board.h"
#include "camera/board_projection.h"
#include "camera/marker_dictionary.h"
#include "io/image.h"

namespace gonio::camera {

class Pattern {
 public:
  explicit Pattern(const Board& board)
      : board_(board), marked_(static_cast<std::size_t>(board.square_rows() * board.square_columns())) {
    if (board.kind != BoardKind::charuco) return;
    for (const Marker& m : markers(board)) {
      const Vec2 middle = (m.corners_m[0] + m.corners_m[2]) * 0.5;
      marked_[index(static_cast<int>(middle.y / board.square_m), static_cast<int>(middle.x / board.square_m))] = {
          m.corners_m[0], marker_cells(board.dictionary, m.id)};
    }
  }
  double reflectance(Vec2 at) const {
    const Vec2 p = at - board_.squares_origin_m();
    const int row = static_cast<int>(std::floor(p.y / board_.square_m)),
              column = static_cast<int>(std::floor(p.x / board_.square_m));
    if (row < 0 || column < 0 || row >= board_.square_rows() || column >= board_.square_columns()) return white;
    if (board_.kind == BoardKind::checkerboard) return (row + column) % 2 == 0 ? black : white;
    const auto& [origin, cells] = marked_[index(row, column)];
    if (cells.side == 0) return black;
    const double cell = board_.marker_m / cells.side;
    const int x = static_cast<int>(std::floor((at.x - origin.x) / cell)),
              y = static_cast<int>(std::floor((at.y - origin.y) / cell));
    if (x < 0 || y < 0 || x >= cells.side || y >= cells.side) return white;
    return cells.black[static_cast<std::size_t>(y * cells.side + x)] ? black : white;
  }

 private:
  static constexpr double black = 0.08, white = 0.85;
  Board board_;
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row * board_.square_columns() + column);
  }
  std::vector<std::pair<Vec2, MarkerCells>> marked_;  // by square; no cells: black
};

inline io::Image photograph(const Board& board, const Intrinsics& pinhole, const BoardPose& pose, int width, int height,
                            double noise = 0, int side = 8) {
  const Pattern pattern(board);
  const Rigid<frame::Board, frame::Camera> board_from_camera = inverse(pose);
  const Vec3 eye = board_from_camera.translation_m;
  const Mat3 turn = matrix_of(board_from_camera.rotation);
  Random random(1);
  io::Image image(width, height, {"Y"});
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int k = 0; k < side * side; ++k) {
        const double u = x - 0.5 + (k % side + 0.5) / side, v = y - 0.5 + (k / side + 0.5) / side;
        const Vec3 d = turn * Vec3{(u - pinhole.cx_px) / pinhole.fx_px, (v - pinhole.cy_px) / pinhole.fy_px, 1};
        sum += pattern.reflectance({eye.x - eye.z * d.x / d.z, eye.y - eye.z * d.y / d.z});
      }
      const double value = sum / (side * side) + (noise > 0 ? noise * random.normal() : 0);
      image.at(x, y, 0) = static_cast<float>(std::round(255 * std::fmin(std::fmax(value, 0), 1)) / 255);
    }
  }
  return image;
}

// The board's middle on the optical axis (moved by `shift`, in half widths of the board), at `distance_m`, turned by a
// rotation vector.
inline BoardPose pose_at(const Board& board, Vec3 rotation, double distance_m, Vec2 shift = {}) {
  BoardPose pose;
  pose.rotation = quaternion_of_rotation_vector(rotation);
  const BoardExtent extent = board.extent();
  const Vec3 middle = pose.rotate({extent.middle_m.x, extent.middle_m.y, 0});
  pose.translation_m = Vec3{shift.x * extent.half_m.x, shift.y * extent.half_m.y, distance_m} - middle;
  return pose;
}

}  // namespace gonio::camera
