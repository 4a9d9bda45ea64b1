// Derivatives in closed form; the pose enters as a first-order change at the given pose, R p -> R p + w x (R p), whose
// derivative at w = 0 is exact.
#include "camera/board_projection.h"

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
  const std::array sag{warp.sag_x_m, warp.sag_y_m};
  const Mat3 r = matrix_of(camera_from_board.rotation);
  const Vec3 q = r * Vec3{at.x, at.y, board_height(extent, at, sag.data())};
  LensMap map;
  if (!lens_map_derivatives(intrinsics.distortion.data(), q + camera_from_board.translation_m, map)) return false;
  pixel = {intrinsics.fx_px * map.x + intrinsics.cx_px, intrinsics.fy_px * map.y + intrinsics.cy_px};
  const std::array x_unit{1.0, 0.0}, y_unit{0.0, 1.0};
  const double rise_x = board_height(extent, at, x_unit.data()), rise_y = board_height(extent, at, y_unit.data());
  for (std::size_t row = 0; row < 2; ++row) {
    auto& j = jacobian[row];
    const double f = row == 0 ? intrinsics.fx_px : intrinsics.fy_px;
    j[0] = row == 0 ? map.x : 0;
    j[1] = row == 0 ? 0 : map.y;
    j[2] = row == 0 ? 1 : 0;
    j[3] = row == 0 ? 0 : 1;
    for (std::size_t i = 0; i < distortion_terms; ++i) j[BoardColumn::distortion + i] = f * map.by_term[row][i];
    const Vec3 g = Vec3{map.by_direction[row][0], map.by_direction[row][1], map.by_direction[row][2]} * f;
    const Vec3 turn = cross(q, g);  // g . (w x q) = w . (q x g)
    const double lift = g.x * r(0, 2) + g.y * r(1, 2) + g.z * r(2, 2);
    for (int i = 0; i < 3; ++i) {
      j[BoardColumn::rotation + static_cast<std::size_t>(i)] = turn[i];
      j[BoardColumn::translation + static_cast<std::size_t>(i)] = g[i];
    }
    j[BoardColumn::warp] = lift * rise_x;
    j[BoardColumn::warp + 1] = lift * rise_y;
  }
  return true;
}

}  // namespace gonio::camera
