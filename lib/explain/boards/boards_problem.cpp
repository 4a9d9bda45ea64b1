// See boards_problem.h.
#include "explain/boards/boards_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "explain/boards/boards_outcome.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

using camera::BoardColumn;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t none = static_cast<std::size_t>(-1);

// Left Jacobian of SO(3): exp([w + dw]x) = exp([J dw]x) exp([w]x); Barfoot, State Estimation for Robotics,
// equation 7.77.
Mat3 left_jacobian(Vec3 w) {
  const double angle = norm(w), a2 = angle * angle;
  const double a = angle > 1e-4 ? (1 - std::cos(angle)) / a2 : 0.5 - a2 / 24;
  const double b = angle > 1e-4 ? (angle - std::sin(angle)) / (a2 * angle) : 1.0 / 6 - a2 / 120;
  const Mat3 k{{0, -w.z, w.y, w.z, 0, -w.x, -w.y, w.x, 0}}, kk = k * k;
  Mat3 j;
  for (std::size_t i = 0; i < 9; ++i) j.m[i] += a * k.m[i] + b * kk.m[i];
  return j;
}

class BoardsProblem : public Problem {
 public:
  explicit BoardsProblem(BoardsInput input) : input_(std::move(input)) {
    settle_views(input_);
    BoardParameters declared = board_parameters(input_);
    parameters_ = std::move(declared.parameters);
    roles_ = std::move(declared.roles);
    base_ = std::move(declared.base);
    candidates_ = std::move(declared.candidates);
    observe();
  }

  std::string domain() const override { return "boards"; }
  std::string unit() const override { return "px"; }
  std::string score_name() const override { return "RMS reprojection error"; }
  std::string group_noun() const override { return "board view"; }
  Importance importance() const override { return Importance::share_of_residual; }
  // Sag, smooth shape and corners each on their own say the same, ever finer.
  bool excludes(std::size_t candidate, std::size_t other) const override {
    const std::string& family = candidates_[candidate].family;
    return family == the_boards_shape && family == candidates_[other].family;
  }
  bool sets_outliers_aside() const override { return true; }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    BoardScene s = board_scene(input_, roles_, values, group);
    const BoardsInput::View& view = input_.views[group];
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      Vec2 pixel{0, 0};
      const bool seen = camera::predict(s.of(view.corners[i]), place_of(view.corners[i]), pixel);
      prediction[2 * i] = seen ? pixel.x : infinity;
      prediction[2 * i + 1] = seen ? pixel.y : infinity;
    }
  }

  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override {
    BoardScene s = board_scene(input_, roles_, values, group);
    const BoardsInput::View& view = input_.views[group];
    const Mat3 turn = left_jacobian(s.turn);
    const std::size_t rows = 2 * view.corners.size();
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      Vec2 pixel{0, 0};
      camera::CornerJacobian j{};
      camera::predict(s.of(view.corners[i]), place_of(view.corners[i]), pixel, j);
      for (std::size_t axis = 0; axis < 2; ++axis) {
        std::array<double, camera::CornerColumn::count>& d = j[axis];
        const std::array<double, 3> w = {d[BoardColumn::rotation], d[BoardColumn::rotation + 1],
                                         d[BoardColumn::rotation + 2]};
        for (int k = 0; k < 3; ++k)
          d[BoardColumn::rotation + static_cast<std::size_t>(k)] =
              w[0] * turn(0, k) + w[1] * turn(1, k) + w[2] * turn(2, k);
        for (std::size_t k = 0; k < columns.size(); ++k)
          derivatives[k * rows + 2 * i + axis] =
              d[roles_[columns[k]].column] * share_of(roles_[columns[k]], group, view.corners[i]);
      }
    }
  }

  // Second differences along the board's rows and columns remove everything that a lens or a bent board can do over
  // three neighbouring corners; what remains has 6 times the variance of a corner (1 + 4 + 1).
  std::optional<double> noise_factor(std::span<const double> residual) const override {
    std::vector<double> differences;
    std::size_t row = 0;
    for (const BoardsInput::View& view : input_.views) {
      const double square = input_.boards[view.board].square_m;
      const auto find = [&](Vec2 at, camera::Colour colour) {
        for (std::size_t k = 0; k < view.corners.size(); ++k)
          if (view.corners[k].colour == colour && norm(view.corners[k].board_m - at) < 0.1 * square) return k;
        return none;
      };
      for (std::size_t i = 0; i < view.corners.size(); ++i)
        for (const Vec2 step : {Vec2{square, 0}, Vec2{0, square}}) {
          const BoardsInput::Corner& own = view.corners[i];
          const std::size_t a = find(own.board_m - step, own.colour), b = find(own.board_m + step, own.colour);
          if (a == none || b == none) continue;
          for (std::size_t axis = 0; axis < 2; ++axis)
            differences.push_back(
                (residual[row + 2 * a + axis] - 2 * residual[row + 2 * i + axis] + residual[row + 2 * b + axis]) /
                (std::sqrt(6.0) * view.corners[i].sigma_px));
        }
      row += 2 * view.corners.size();
    }
    if (differences.size() < 30) return std::nullopt;
    return std::max(1e-6, stats::robust_sigma(differences));
  }

  std::vector<Proposal> proposals() const override {
    std::vector<Proposal> told;
    for (const BoardProposal& p : board_proposals(input_)) told.push_back(p.told);
    return told;
  }
  // A proposed view has a pose of its own: six numbers of nuisance.
  ProposedRows propose(std::span<const double> values, std::size_t proposal) const override {
    BoardsInput input = input_;
    const std::size_t number = input.views.size();
    input.views.push_back(board_proposals(input_)[proposal].view);
    input.views.back().pose_of = number;
    const BoardScene s = board_scene(input, roles_, values, number);
    ProposedRows rows;
    rows.nuisance.resize(6);
    for (const BoardsInput::Corner& corner : input.views.back().corners) {
      Vec2 pixel{infinity, infinity};
      camera::CornerJacobian j{};
      camera::predict(s.model, place_of(corner), pixel, j);
      for (std::size_t axis = 0; axis < 2; ++axis) {
        rows.prediction.push_back(axis == 0 ? pixel.x : pixel.y);
        rows.sigma.push_back(corner.sigma_px);
        for (std::size_t k = 0; k < 6; ++k) rows.nuisance[k].push_back(j[axis][BoardColumn::rotation + k]);
      }
    }
    return rows;
  }

  std::string remarks(const Explanation& e) const override {
    std::string text;
    for (const std::string& said :
         {shapes_in_words(*this, input_, roles_, e), prints_in_words(*this, input_, roles_, e),
          rivals_cost(*this, input_, roles_, e), uneven_print(input_, e)})
      text += (text.empty() || said.empty() ? "" : " ") + said;
    return text;
  }
  std::optional<Testimony> objection(const Explanation& e, std::size_t candidate) const {
    return motion_objection(*this, input_, roles_, e, candidate);
  }
  void apply(const Explanation& e, manifest::Document& document) const override {
    upgrade_boards(*this, input_, roles_, e, document);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_boards(input_, observations_, e);
  }

 private:
  static camera::CornerPlace place_of(const BoardsInput::Corner& c) { return {c.board_m, c.colour, c.turned_rad}; }
  // Of a parameter in what its column has for a corner.
  double share_of(const BoardRole& role, std::size_t group, const BoardsInput::Corner& corner) const {
    const BoardsInput::View& view = input_.views[group];
    const std::size_t own = role.column < BoardColumn::warp ? view.pose_of : group;
    if (!((role.camera == none || role.camera == view.camera) && (role.board == none || role.board == view.board) &&
          (role.view == none || role.view == own)))
      return 0;
    if (role.corner == none) return 1;
    if (corner.of_board == none) return 0;
    return input_.boards[role.board].print.slope(role.column - camera::CornerColumn::print, corner.of_board,
                                                 role.corner);
  }

  void observe() {
    Observations& o = observations_;
    o.first.push_back(0);
    o.conditions = board_conditions(input_);
    std::uint32_t block = 0;
    for (const BoardsInput::View& view : input_.views) {
      o.group.push_back(view.image);
      for (const BoardsInput::Corner& corner : view.corners) {
        for (const double v : {corner.pixel.x, corner.pixel.y}) {
          o.value.push_back(v);
          o.sigma.push_back(corner.sigma_px);
          o.norm.push_back(0.5);
          o.block.push_back(block);
        }
        ++block;
      }
      o.first.push_back(o.value.size());
    }
  }

  BoardsInput input_;
  std::vector<BoardRole> roles_;
};

}  // namespace

std::optional<Testimony> boards_objection(const Problem& problem, const Explanation& e, std::size_t candidate) {
  const auto* boards = dynamic_cast<const BoardsProblem*>(&problem);
  return boards == nullptr ? std::nullopt : boards->objection(e, candidate);
}

std::unique_ptr<Problem> boards_problem(BoardsInput input) {
  return std::make_unique<BoardsProblem>(std::move(input));
}

}  // namespace gonio::explain
