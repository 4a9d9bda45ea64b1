// Derivatives by dual numbers (Ceres' Jets) over the templates of board_terms.h; the pose enters as a first-order
// change at the given pose, R p -> R p + w x (R p), whose derivative at w = 0 is exact.
#include "camera/board_projection.h"

#include <ceres/jet.h>

namespace gonio::camera {

BoardPose moved(const BoardPose& pose, const std::array<double, 6>& change) {
  BoardPose result = pose;
  result.rotation = normalized(quaternion_of_rotation_vector({change[0], change[1], change[2]}) * pose.rotation);
  result.translation_m = pose.translation_m + Vec3{change[3], change[4], change[5]};
  return result;
}

bool predict(const Intrinsics& intrinsics, const BoardPose& camera_from_board, const BoardExtent& extent,
             const BoardWarp& warp, Vec2 at, Vec2& pixel) {
  const std::array sag{warp.sag_x_m, warp.sag_y_m};
  const Vec3 p = camera_from_board * Vec3{at.x, at.y, board_height(extent, at, sag.data())};
  const std::array point{p.x, p.y, p.z};
  const std::array pinhole{intrinsics.fx_px, intrinsics.fy_px, intrinsics.cx_px, intrinsics.cy_px};
  std::array<double, 2> uv{};
  if (!project_point(point.data(), pinhole.data(), intrinsics.distortion.data(), uv.data())) return false;
  pixel = {uv[0], uv[1]};
  return true;
}

bool predict(const Intrinsics& intrinsics, const BoardPose& camera_from_board, const BoardExtent& extent,
             const BoardWarp& warp, Vec2 at, Vec2& pixel,
             std::array<std::array<double, BoardColumn::count>, 2>& jacobian) {
  using Jet = ceres::Jet<double, static_cast<int>(BoardColumn::count)>;
  const auto variable = [](double value, std::size_t column) { return Jet(value, static_cast<int>(column)); };
  const std::array pinhole{variable(intrinsics.fx_px, 0), variable(intrinsics.fy_px, 1), variable(intrinsics.cx_px, 2),
                           variable(intrinsics.cy_px, 3)};
  std::array<Jet, distortion_terms> distortion;
  for (std::size_t i = 0; i < distortion_terms; ++i) {
    distortion[i] = variable(intrinsics.distortion[i], BoardColumn::distortion + i);
  }
  const std::array sag{variable(warp.sag_x_m, BoardColumn::warp), variable(warp.sag_y_m, BoardColumn::warp + 1)};
  const Jet height = board_height(extent, at, sag.data());
  const Mat3 r = matrix_of(camera_from_board.rotation);
  const Vec3 turned = r * Vec3{at.x, at.y, height.a};
  const std::array<double, 3> q{turned.x, turned.y, turned.z};
  const std::array<double, 3> t{camera_from_board.translation_m.x, camera_from_board.translation_m.y,
                                camera_from_board.translation_m.z};
  std::array<Jet, 3> point;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    point[i] = Jet(q[i] + t[i]);
    point[i].v = r(static_cast<int>(i), 2) * height.v;
    point[i].v[static_cast<int>(BoardColumn::rotation + j)] += q[k];  // (w x q)_i = w_j q_k - w_k q_j
    point[i].v[static_cast<int>(BoardColumn::rotation + k)] -= q[j];
    point[i].v[static_cast<int>(BoardColumn::translation + i)] += 1;
  }
  std::array<Jet, 2> uv;
  if (!project_point(point.data(), pinhole.data(), distortion.data(), uv.data())) return false;
  pixel = {uv[0].a, uv[1].a};
  for (std::size_t row = 0; row < 2; ++row) {
    for (std::size_t c = 0; c < BoardColumn::count; ++c) jacobian[row][c] = uv[row].v[static_cast<int>(c)];
  }
  return true;
}

}  // namespace gonio::camera
