// Views of a board that could be taken next, in an order that does not depend on what was observed in them. The board
// faces the camera at the identity: x to the right, y down, z away.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "explain/boards/boards_outcome.h"
#include "geom/angle.h"
#include "manifest/codec.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

constexpr std::size_t fewest_corners = 6;

struct Setting {
  const char* sentence;
  double range;         // over the median range of the recordings
  double across, down;  // where the board's middle lies, in half widths and half heights of the image
  Vec3 turn_rad;        // rotation vectors about the camera's axes, tilt after roll
  double roll_rad;
};
constexpr Setting settings[] = {
    {"a view of the board facing the camera at half the range", 0.5, 0, 0, {0, 0, 0}, 0},
    {"a view of the board facing the camera at twice the range", 2, 0, 0, {0, 0, 0}, 0},
    {"a view of the board tilted by 45 degrees about the vertical", 1, 0, 0, {0, 45 * degree, 0}, 0},
    {"a view of the board tilted by 45 degrees about the horizontal", 1, 0, 0, {45 * degree, 0, 0}, 0},
    {"a view of the board turned by 90 degrees in its plane and tilted by 30",
     1,
     0,
     0,
     {0, 30 * degree, 0},
     90 * degree},
    {"a view of the board upside down (or the camera rolled by 180 degrees)",
     1,
     0,
     0,
     {0, 30 * degree, 0},
     180 * degree},
    {"a view of the board in the upper left corner of the image", 0.8, -0.6, -0.6, {0, 0, 0}, 0},
    {"a view of the board in the lower right corner of the image", 0.8, 0.6, 0.6, {0, 0, 0}, 0},
    {"a view of the board at half the range, tilted by 50 degrees", 0.5, 0, 0, {30 * degree, 40 * degree, 0}, 0},
    {"a view of the board at half the range, turned by 90 degrees and tilted by 50",
     0.5,
     0,
     0,
     {30 * degree, 40 * degree, 0},
     90 * degree}};

// Every corner of the board that any view shows, once for each colour.
std::vector<BoardsInput::Corner> corners_of(const BoardsInput& input, double sigma_px) {
  std::vector<BoardsInput::Corner> corners;
  for (const BoardsInput::View& view : input.views) {
    if (view.board != input.views[0].board || view.camera != input.views[0].camera) continue;
    for (const BoardsInput::Corner& c : view.corners) {
      const auto same = [&](const BoardsInput::Corner& other) {
        return other.colour == c.colour && norm(other.board_m - c.board_m) < 1e-9;
      };
      if (std::none_of(corners.begin(), corners.end(), same)) corners.push_back({c.board_m, {}, sigma_px, c.colour, 0});
    }
  }
  return corners;
}

camera::BoardPose pose_of(const Setting& s, const camera::Intrinsics& k, int width_px, int height_px,
                          const camera::BoardExtent& extent, double range_m) {
  camera::BoardPose pose;
  pose.rotation = quaternion_of_rotation_vector(s.turn_rad) * quaternion_of_rotation_vector({0, 0, s.roll_rad});
  const double z = s.range * range_m;
  const double u = (0.5 + 0.5 * s.across) * width_px, v = (0.5 + 0.5 * s.down) * height_px;
  const Vec3 middle{(u - k.cx_px) / k.fx_px * z, (v - k.cy_px) / k.fy_px * z, z};
  pose.translation_m = middle - pose.rotate({extent.middle_m.x, extent.middle_m.y, 0});
  return pose;
}

}  // namespace

std::vector<BoardProposal> board_proposals(const BoardsInput& input) {
  std::vector<BoardProposal> result;
  if (input.views.empty()) return result;
  const std::size_t c = input.views[0].camera, b = input.views[0].board;
  const BoardsInput::Camera& camera = input.cameras[c];
  const BoardsInput::Board& board = input.boards[b];
  std::vector<double> range, sigma;
  for (const BoardsInput::View& view : input.views) {
    if (view.camera != c || view.board != b) continue;
    range.push_back((view.camera_from_board * Vec3{board.extent.middle_m.x, board.extent.middle_m.y, 0}).z);
    for (const BoardsInput::Corner& corner : view.corners) sigma.push_back(corner.sigma_px);
  }
  const std::vector<BoardsInput::Corner> corners = corners_of(input, stats::median(sigma));
  for (const Setting& s : settings) {
    BoardProposal p;
    p.told.sentence = s.sentence;
    p.view.image = "proposed";
    p.view.camera = c, p.view.board = b;
    p.view.camera_from_board =
        pose_of(s, camera.intrinsics, camera.width_px, camera.height_px, board.extent, stats::median(range));
    for (const BoardsInput::Corner& corner : corners) {
      Vec2 pixel{-1, -1};
      if (!camera::predict(camera.intrinsics, p.view.camera_from_board, board.extent, board.warp, corner.board_m,
                           pixel))
        continue;
      if (pixel.x < 0 || pixel.y < 0 || pixel.x > camera.width_px - 1 || pixel.y > camera.height_px - 1) continue;
      p.view.corners.push_back(corner);
    }
    if (p.view.corners.size() < fewest_corners) continue;
    manifest::Pose<frame::Camera, frame::Board> written;
    written.rotation = p.view.camera_from_board.rotation;
    written.translation_m = p.view.camera_from_board.translation_m;
    p.told.setup = manifest::Value::object(
        {{"images", manifest::Value(manifest::Value::Array{manifest::Value::object(
                        {{"camera", camera.name},
                         {"board", board.name},
                         {"camera_from_board", manifest::Codec<decltype(written)>::write(written)}})})}});
    result.push_back(std::move(p));
  }
  return result;
}

}  // namespace gonio::explain
