// Conditions of board corners, each with the direction in (u, v) along which its physics would act: lens terms along
// the image radius, a bent board along what a height above the board does to the pixel, a stretched one along its x
// axis; whether the stretch is the board's or the focal lengths' shows over its roll.
#include <algorithm>
#include <cmath>

#include "explain/boards/boards_outcome.h"

namespace gonio::explain {
namespace {

std::vector<Condition> names() {
  return {{"camera.image-radius", "half diagonal", "lens", {}, {}, "px"},
          {"camera.image-azimuth", "rad", "lens", {}, {}, "px"},
          {"camera.image-x", "half width", "sensor", {}, {}, "px"},
          {"camera.image-y", "half height", "sensor", {}, {}, "px"},
          {"camera.distance", "m", "lens", {}, {}, "px"},
          {"board.radius", "half board", "board", {}, {}, "mm"},
          {"board.x", "half board", "board", {}, {}, "mm"},
          {"board.y", "half board", "board", {}, {}, "mm"},
          {"board.roll", "rad", "board", {}, {}, "0.1 %"},
          {"camera.image-radius-over-distance", "half diagonal/m", "optics", {}, {}, "px"},
          {"camera.channel", "1", "optics", {}, {}, "px"},
          {"camera.image-radius-by-channel", "half diagonal", "optics", {}, {}, "px"},
          {"camera.turned", "rad", "sensor", {}, {}, "px"},
          {"camera.temperature", "K", "sensor", {}, {}, "px"},
          {"camera.temperature-in-x", "K", "sensor", {}, {}, "px"},
          {"camera.temperature-in-y", "K", "sensor", {}, {}, "px"},
          {"camera.time", "s", "sensor", {}, {}, "px"},
          {"camera.time-in-x", "s", "sensor", {}, {}, "px"},
          {"camera.time-in-y", "s", "sensor", {}, {}, "px"}};
}

struct Entry {
  double value = 0;
  Vec2 direction;
};

// In the order of names().
std::vector<Entry> entries(const BoardsInput& input, const BoardsInput::View& view, const BoardsInput::Corner& corner) {
  const BoardsInput::Camera& camera = input.cameras[view.camera];
  const BoardsInput::Board& board = input.boards[view.board];
  const camera::Intrinsics& k = camera.intrinsics;
  // The predicted pixel: with the detected one, its noise would be condition and residual at once.
  Vec2 pixel = corner.pixel;
  camera::predict(k, view.camera_from_board, board.extent, board.warp, corner.board_m, pixel);
  const Vec2 from_centre = pixel - Vec2{k.cx_px, k.cy_px};
  const double half_x = 0.5 * camera.width_px, half_y = 0.5 * camera.height_px;
  const double radius_px = norm(from_centre), radius = radius_px / std::hypot(half_x, half_y);
  const Vec2 outward = radius_px > 0 ? from_centre * (1 / radius_px) : Vec2{0, 0};
  const Vec3 at = view.camera_from_board * Vec3{corner.board_m.x, corner.board_m.y, 0};
  const auto millimetre = [&](Vec3 axis) { return by_millimetre(input, view, corner, axis); };
  const Vec2 lift = millimetre({0, 0, 1});
  const double x = (corner.board_m.x - board.extent.middle_m.x) / board.extent.half_m.x;
  const double y = (corner.board_m.y - board.extent.middle_m.y) / board.extent.half_m.y;
  // Modulo half a turn, with the other sign on the opposite side: decentring differs there, a radial term does not.
  const double azimuth = std::atan2(from_centre.y, from_centre.x), half_azimuth = azimuth < 0 ? azimuth + pi : azimuth;
  const bool opposite = azimuth < 0;
  const Vec3 along = view.camera_from_board.rotate({1, 0, 0});
  const double roll = std::atan(along.y / along.x);  // modulo half a turn, as a stretch is
  const double channel = static_cast<double>(corner.colour);
  return {{radius, outward},
          {half_azimuth, outward * (opposite ? -radius * radius : radius * radius)},
          {from_centre.x / half_x, {1, 0}},
          {from_centre.y / half_y, {0, 1}},
          {norm(at), outward},
          {std::hypot(x, y), lift},
          {x, lift},
          {y, lift},
          {roll, millimetre({1, 0, 0}) * (corner.board_m.x - board.extent.middle_m.x)},  // 0.1 % longer in x
          {radius / norm(at), outward},
          {channel, outward * radius},
          {(channel - 1) * radius, outward},
          {corner.turned_rad, {std::cos(corner.turned_rad), std::sin(corner.turned_rad)}},
          {view.warmer_K, outward * radius},
          {view.warmer_K, {1, 0}},
          {view.warmer_K, {0, 1}},
          {view.later_s, outward * radius},
          {view.later_s, {1, 0}},
          {view.later_s, {0, 1}}};
}

bool varies(const Condition& c) {
  return std::any_of(c.values.begin(), c.values.end(), [&](double v) { return v != c.values.front(); });
}

}  // namespace

Vec2 by_millimetre(const BoardsInput& input, const BoardsInput::View& view, const BoardsInput::Corner& corner,
                   Vec3 axis) {
  const camera::Intrinsics& k = input.cameras[view.camera].intrinsics;
  const Vec3 at = view.camera_from_board * Vec3{corner.board_m.x, corner.board_m.y, 0};
  const Vec3 a = view.camera_from_board.rotate(axis);
  return {1e-3 * k.fx_px * (a.x - at.x / at.z * a.z) / at.z, 1e-3 * k.fy_px * (a.y - at.y / at.z * a.z) / at.z};
}

std::vector<Condition> board_conditions(const BoardsInput& input) {
  std::vector<Condition> conditions = names();
  for (const BoardsInput::View& view : input.views)
    for (const BoardsInput::Corner& corner : view.corners) {
      const std::vector<Entry> own = entries(input, view, corner);
      for (std::size_t c = 0; c < own.size(); ++c) {
        conditions[c].values.insert(conditions[c].values.end(), 2, own[c].value);
        conditions[c].direction.push_back(own[c].direction.x);
        conditions[c].direction.push_back(own[c].direction.y);
      }
    }
  // Where there is but one channel, a radius times the channel says nothing that the radius does not.
  const bool coloured = varies(conditions[10]);
  std::erase_if(conditions, [&](const Condition& c) {
    return !varies(c) || (!coloured && c.name == "camera.image-radius-by-channel");
  });
  return conditions;
}

}  // namespace gonio::explain
