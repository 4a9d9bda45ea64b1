// Photographs of boards whose corners are known: every pixel is the mean of the printed pattern over its square and the
// lens's point spread, 8 x 8 samples a pixel, through a lens of this file's own; and poses that look at the board from
// all around.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
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
          m.corners_m[0], board.cells(m.id)};
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

// A lens of its own, so that what tests know does not come from what they test: coefficients as OpenCV defines them,
//   R = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6), and p1, p2 (Brown 1971).
struct Lens {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0, k5 = 0, k6 = 0;

  Vec2 pixel(Vec2 p) const {  // of normalised coordinates X / Z, Y / Z
    const double r2 = dot(p, p);
    const double radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)));
    const double u = p.x * radial + 2 * p1 * p.x * p.y + p2 * (r2 + 2 * p.x * p.x);
    const double v = p.y * radial + p1 * (r2 + 2 * p.y * p.y) + 2 * p2 * p.x * p.y;
    return {fx * u + cx, fy * v + cy};
  }
  Vec2 pixel(Vec3 p) const { return pixel(Vec2{p.x / p.z, p.y / p.z}); }
  // The inverse by Newton's method with differences, from a start near by.
  Vec2 normalised(Vec2 target, Vec2 start) const {
    Vec2 p = start;
    for (int i = 0; i < 20; ++i) {
      constexpr double h = 1e-6;
      const Vec2 here = pixel(p), miss = target - here;
      const Vec2 dx = (pixel(p + Vec2{h, 0}) - here) * (1 / h), dy = (pixel(p + Vec2{0, h}) - here) * (1 / h);
      const double det = dx.x * dy.y - dx.y * dy.x;
      p = p + Vec2{(miss.x * dy.y - miss.y * dy.x) / det, (dx.x * miss.y - dx.y * miss.x) / det};
      if (norm(miss) < 1e-9) break;
    }
    return p;
  }
};

struct Exposure {
  double blur_px = 0;  // standard deviation of the lens's point spread
  double noise = 0;    // standard deviation of the sensor's, full scale 1
  int side = 8;        // samples along one side of a pixel
  std::uint64_t seed = 1;
};

// Means of reflectance(board point) over the pixels, convolved with the point spread: side x side samples a pixel on a
// regular grid, weighted by the box of the pixel convolved with the Gaussian. Between the corners of a pixel, board
// coordinates are interpolated, which moves nothing by more than 1e-3 px.
template <class Reflectance>
std::vector<float> expose(const Reflectance& reflectance, const Lens& lens, const BoardPose& pose, int width,
                          int height, const Exposure& e) {
  const Rigid<frame::Board, frame::Camera> board_from_camera = inverse(pose);
  const Vec3 eye = board_from_camera.translation_m;
  const Mat3 turn = matrix_of(board_from_camera.rotation);
  const auto board_row = [&](int y) {  // board coordinates of the pixels' upper left corners along row y
    std::vector<Vec2> row;
    for (int x = 0; x <= width; ++x) {
      const Vec2 p{x - 0.5, y - 0.5};
      const Vec2 n = lens.normalised(p, {(p.x - lens.cx) / lens.fx, (p.y - lens.cy) / lens.fy});
      const Vec3 d = turn * Vec3{n.x, n.y, 1};
      row.push_back({eye.x - eye.z * d.x / d.z, eye.y - eye.z * d.y / d.z});
    }
    return row;
  };
  const int reach = static_cast<int>(std::ceil(4 * e.blur_px)), taps = (2 * reach + 1) * e.side;
  std::vector<float> weights;
  double sum = 0;
  for (int k = 0; k < taps; ++k) {
    const double z = (k + 0.5) / e.side - 0.5 - reach, s = std::sqrt(2.0) * e.blur_px;
    const double w = e.blur_px > 0 ? std::erf((z + 0.5) / s) - std::erf((z - 0.5) / s) : 1;
    weights.push_back(static_cast<float>(w));
    sum += w;
  }
  for (float& w : weights) w /= static_cast<float>(sum);

  const int rows = height * e.side, columns = width * e.side;
  std::vector<float> line(static_cast<std::size_t>(columns)), across(static_cast<std::size_t>(rows) * width);
  std::vector<Vec2> above, below = board_row(0);
  for (int row = 0; row < rows; ++row) {
    if (row % e.side == 0) {
      above = std::move(below);
      below = board_row(row / e.side + 1);
    }
    const double f = (row % e.side + 0.5) / e.side;
    for (int x = 0; x < width; ++x) {
      const Vec2 a = above[x] * (1 - f) + below[x] * f, b = above[x + 1] * (1 - f) + below[x + 1] * f;
      for (int k = 0; k < e.side; ++k) {
        const double g = (k + 0.5) / e.side;
        line[x * e.side + k] = static_cast<float>(reflectance(a * (1 - g) + b * g));
      }
    }
    for (int x = 0; x < width; ++x) {
      float value = 0;
      const int first = (x - reach) * e.side;
      for (int k = 0; k < taps; ++k) value += weights[k] * line[std::clamp(first + k, 0, columns - 1)];
      across[static_cast<std::size_t>(row) * width + x] = value;
    }
  }
  std::vector<float> picture(static_cast<std::size_t>(width) * height, 0.0F);
  for (int y = 0; y < height; ++y) {
    for (int k = 0; k < taps; ++k) {
      const float* from = &across[static_cast<std::size_t>(std::clamp((y - reach) * e.side + k, 0, rows - 1)) * width];
      for (int x = 0; x < width; ++x) picture[static_cast<std::size_t>(y) * width + x] += weights[k] * from[x];
    }
  }
  return picture;
}

// With the sensor's noise, in 8 bit.
inline io::Image developed(const std::vector<float>& picture, int width, int height, const Exposure& e) {
  Random random(e.seed);
  io::Image image(width, height, {"Y"});
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const double value = picture[i] + (e.noise > 0 ? e.noise * random.normal() : 0);
    image.data[i] = static_cast<float>(std::round(255 * std::fmin(std::fmax(value, 0), 1)) / 255);
  }
  return image;
}

inline io::Image photograph(const Board& board, const Lens& lens, const BoardPose& pose, int width, int height,
                            const Exposure& e) {
  const Pattern pattern(board);
  return developed(expose([&](Vec2 at) { return pattern.reflectance(at); }, lens, pose, width, height, e), width,
                   height, e);
}

inline io::Image photograph(const Board& board, const Intrinsics& pinhole, const BoardPose& pose, int width, int height,
                            double noise = 0, int side = 8) {
  return photograph(board, {pinhole.fx_px, pinhole.fy_px, pinhole.cx_px, pinhole.cy_px}, pose, width, height,
                    {0, noise, side, 1});
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
