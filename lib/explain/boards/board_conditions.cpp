// Conditions of board corners, each with the direction in (u, v) along which its physics would act: lens terms along
// the image radius, a bent board along what a height above the board does to the pixel.
#include <cmath>

#include "explain/boards/boards_outcome.h"

namespace gonio::explain {

std::vector<Condition> board_conditions() {
  return {{"camera.image-radius", "half diagonal", "lens", {}, {}, "px"},
          {"camera.image-azimuth", "rad", "lens", {}, {}, "px"},
          {"camera.image-x", "half width", "sensor", {}, {}, "px"},
          {"camera.image-y", "half height", "sensor", {}, {}, "px"},
          {"camera.distance", "m", "lens", {}, {}, "px"},
          {"board.radius", "half board", "board", {}, {}, "mm"},
          {"board.x", "half board", "board", {}, {}, "mm"},
          {"board.y", "half board", "board", {}, {}, "mm"}};
}

void append_conditions(const BoardsInput::Camera& camera, const BoardsInput::Board& board,
                       const BoardsInput::View& view, const BoardsInput::Corner& corner,
                       std::vector<Condition>& conditions) {
  const camera::Intrinsics& k = camera.intrinsics;
  // The predicted pixel: with the detected one, its noise would be condition and residual at once.
  Vec2 pixel = corner.pixel;
  camera::predict(k, view.camera_from_board, board.extent, board.warp, corner.board_m, pixel);
  const Vec2 from_centre = pixel - Vec2{k.cx_px, k.cy_px};
  const double half_x = 0.5 * camera.width_px, half_y = 0.5 * camera.height_px;
  const double radius_px = norm(from_centre), radius = radius_px / std::hypot(half_x, half_y);
  const Vec2 outward = radius_px > 0 ? from_centre * (1 / radius_px) : Vec2{0, 0};
  const Vec3 at = view.camera_from_board * Vec3{corner.board_m.x, corner.board_m.y, 0};
  const Vec3 normal = view.camera_from_board.rotate({0, 0, 1});
  // d(u, v) for one millimetre along the board's normal.
  const Vec2 lift{1e-3 * k.fx_px * (normal.x - at.x / at.z * normal.z) / at.z,
                  1e-3 * k.fy_px * (normal.y - at.y / at.z * normal.z) / at.z};
  const double x = (corner.board_m.x - board.extent.middle_m.x) / board.extent.half_m.x;
  const double y = (corner.board_m.y - board.extent.middle_m.y) / board.extent.half_m.y;
  std::size_t next = 0;
  const auto append = [&](double value, Vec2 direction) {
    Condition& c = conditions[next++];
    c.values.insert(c.values.end(), 2, value);
    c.direction.push_back(direction.x);
    c.direction.push_back(direction.y);
  };
  append(radius, outward);
  append(std::atan2(from_centre.y, from_centre.x), outward * (radius * radius));
  append(from_centre.x / half_x, {1, 0});
  append(from_centre.y / half_y, {0, 1});
  append(norm(at), outward);
  append(std::hypot(x, y), lift);
  append(x, lift);
  append(y, lift);
}

}  // namespace gonio::explain
