// Motions of a rolling shutter that are none. While a picture is read the hand moves as it happens to, and knows
// nothing of where the board stands; an error that all views share (of the lens, of the board), taken up by numbers of
// single views, goes with the board's place and tilt. Each view's motion is predicted from these by the other views
// (least squares; leave one out by the hat matrix, Allen, Technometrics 16, 1974).
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "explain/boards/boards_outcome.h"
#include "linear/solve.h"

namespace gonio::explain {
namespace {

constexpr std::size_t fewest_views = 8;
constexpr double predicted_share = 0.5;

// What a stretch of the board's print does to a view turns with the board: the second harmonics of its roll.
std::vector<double> by_roll(const camera::BoardPose& pose) {
  const Vec3 along = pose.rotate({1, 0, 0});
  const double roll = std::atan2(along.y, along.x);
  return {1, std::cos(2 * roll), std::sin(2 * roll)};
}
// What a lens or a bent board does goes with tilt, place and nearness: the first few where views are few.
std::vector<double> by_place(const camera::BoardPose& pose, Vec2 middle_m, std::size_t count) {
  const Vec3 middle = pose * Vec3{middle_m.x, middle_m.y, 0}, normal = pose.rotate({0, 0, 1});
  std::vector<double> all = {1, normal.x, normal.y, middle.x / middle.z, middle.y / middle.z, 1 / middle.z};
  all.resize(std::min(all.size(), count));
  return all;
}

// Share of the mean square of y, each row predicted from x by the other rows, that is not predicted.
double missed_share(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
  Eigen::MatrixXd normal = x.transpose() * x;
  normal.diagonal().array() *= 1 + 1e-9;
  const Eigen::MatrixXd hat = x * linear::inverse(normal) * x.transpose(), left = y - hat * y;
  const auto n = static_cast<double>(y.rows());
  double missed = 0, all = 0;
  for (Eigen::Index r = 0; r < y.rows(); ++r) {
    missed += left.row(r).squaredNorm() / std::pow(std::max(1e-9, 1 - hat(r, r)), 2);
    all += (y.row(r) - y.colwise().mean()).squaredNorm() * std::pow(n / (n - 1), 2);  // from the mean of the others
  }
  return all > 0 ? missed / all : 1;
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
    if (e.values[p] != 0) moves[role.view] = true;  // views that are left out keep zeros
  }
  const auto n = static_cast<std::size_t>(std::ranges::count(moves, true));
  if (n < fewest_views) return std::nullopt;
  Eigen::MatrixXd roll(n, 3), place(n, std::min<std::size_t>(6, n / 2)), y(n, 2);
  Eigen::Index row = 0;
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    if (!moves[v]) continue;
    const camera::BoardPose pose = board_scene(input, roles, e.values, v).model.pose;
    const std::vector<double> a = by_roll(pose), b = by_place(pose, input.boards[input.views[v].board].extent.middle_m,
                                                              static_cast<std::size_t>(place.cols()));
    roll.row(row) = Eigen::Map<const Eigen::RowVectorXd>(a.data(), roll.cols());
    place.row(row) = Eigen::Map<const Eigen::RowVectorXd>(b.data(), place.cols());
    const double px_per_m = input.cameras[input.views[v].camera].intrinsics.fx_px / pose.translation_m.z;
    y.row(row) << motions[v][0] * px_per_m, motions[v][1] * px_per_m;
    ++row;
  }
  Testimony t{"how the board stands",
              "the part of its motions that the poses of other views do not predict",
              "1",
              1,
              std::min({1.0, missed_share(roll, y), missed_share(place, y)}),
              0};
  t.refuted = t.after < 1 - predicted_share;
  return t;
}

}  // namespace gonio::explain
