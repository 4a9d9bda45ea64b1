// Motions of a rolling shutter that are none. While a picture is read the hand moves as it happens to, and knows
// nothing of where the board stands; an error that all views share (of the lens, of the board), taken up by numbers of
// single views, goes with the board's place and tilt. Each view's motion is predicted from these by the other views
// (least squares; leave one out by the hat matrix, Allen, Technometrics 16, 1974).
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "explain/boards/boards_outcome.h"
#include "linear/solve.h"

namespace gonio::explain {
namespace {

constexpr std::size_t fewest_views = 8, most_features = 6;
constexpr double predicted_share = 0.5;

// One, tilt, place and nearness: the first few serve where views are few.
std::array<double, most_features> features(const BoardsInput& input, const BoardsInput::View& view,
                                           const camera::BoardPose& pose) {
  const Vec2 middle_m = input.boards[view.board].extent.middle_m;
  const Vec3 middle = pose * Vec3{middle_m.x, middle_m.y, 0}, normal = pose.rotate({0, 0, 1});
  return {1, normal.x, normal.y, middle.x / middle.z, middle.y / middle.z, 1 / middle.z};
}

}  // namespace

std::optional<Testimony> motion_objection(const Problem& problem, const BoardsInput& input,
                                          const std::vector<BoardRole>& roles, const Explanation& e,
                                          std::size_t candidate) {
  using camera::CornerColumn;
  std::vector<std::array<double, 2>> motions(input.views.size(), {0, 0});
  std::vector<bool> moves(input.views.size());
  for (const std::size_t p : problem.candidates()[candidate].parameters) {
    const BoardRole& role = roles[p];
    if (role.view == static_cast<std::size_t>(-1) || role.column < CornerColumn::motion ||
        role.column >= CornerColumn::scale)
      return std::nullopt;
    motions[role.view][role.column - CornerColumn::motion] = e.values[p];
    moves[role.view] = true;
  }
  const auto n = static_cast<std::size_t>(std::ranges::count(moves, true));
  if (n < fewest_views) return std::nullopt;
  const auto rows = static_cast<Eigen::Index>(n);
  const auto columns = static_cast<Eigen::Index>(std::min(most_features, n / 2));
  Eigen::MatrixXd x(rows, columns), y(rows, 2);
  Eigen::Index row = 0;
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    if (!moves[v]) continue;
    const camera::BoardPose pose = board_scene(input, roles, e.values, v).model.pose;
    const auto own = features(input, input.views[v], pose);
    for (Eigen::Index c = 0; c < columns; ++c) x(row, c) = own[static_cast<std::size_t>(c)];
    const double px_per_m = input.cameras[input.views[v].camera].intrinsics.fx_px / pose.translation_m.z;
    y.row(row) << motions[v][0] * px_per_m, motions[v][1] * px_per_m;
    ++row;
  }
  Eigen::MatrixXd normal = x.transpose() * x;
  normal.diagonal().array() *= 1 + 1e-9;
  const Eigen::MatrixXd hat = x * linear::inverse(normal) * x.transpose();
  const Eigen::MatrixXd left = y - hat * y;
  double missed = 0, all = 0;
  const double one_left_out = static_cast<double>(n) / static_cast<double>(n - 1);  // the mean of the others
  for (Eigen::Index r = 0; r < rows; ++r) {
    missed += left.row(r).squaredNorm() / std::pow(std::max(1e-9, 1 - hat(r, r)), 2);
    all += (y.row(r) - y.colwise().mean()).squaredNorm() * one_left_out * one_left_out;
  }
  Testimony t{"where the board stands",
              "the part of its motions that poses of other views do not predict",
              "1",
              1,
              all > 0 ? missed / all : 1,
              0};
  t.refuted = t.after < 1 - predicted_share;
  return t;
}

}  // namespace gonio::explain
