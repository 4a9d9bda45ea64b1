// See boards_problem.h.
#include "explain/boards/boards_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "explain/boards/boards_outcome.h"
#include "explain/boards/rolling_shutter.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

using camera::BoardColumn;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t none = static_cast<std::size_t>(-1);
constexpr std::array<const char*, 4> intrinsic_names = {"fx_px", "fy_px", "cx_px", "cy_px"};
constexpr std::array<const char*, 6> pose_names = {"rotation_x_rad",  "rotation_y_rad",  "rotation_z_rad",
                                                   "translation_x_m", "translation_y_m", "translation_z_m"};

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
    for (std::size_t c = 0; c < input_.cameras.size(); ++c) declare_camera(c);
    for (std::size_t b = 0; b < input_.boards.size(); ++b) declare_board(b);
    for (std::size_t v = 0; v < input_.views.size(); ++v) declare_view(v);
    for (const char* id : {"lens.radial", "lens.rational", "lens.tangential", "lens.thin-prism", "lens.fisheye"})
      declare_lens(id);
    declare_warp();
    declare_rolling_shutter();
    observe();
  }

  std::string domain() const override { return "boards"; }
  std::string unit() const override { return "px"; }
  std::string score_name() const override { return "RMS reprojection error"; }
  std::string group_noun() const override { return "board view"; }
  Importance importance() const override { return Importance::share_of_residual; }
  bool sets_outliers_aside() const override { return true; }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    const Scene s = scene(values, group);
    const BoardsInput::View& view = input_.views[group];
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      Vec2 pixel{0, 0};
      const bool seen =
          predict_moving(s.intrinsics, s.pose, s.extent, s.warp, s.readout, view.corners[i].board_m, pixel);
      prediction[2 * i] = seen ? pixel.x : infinity;
      prediction[2 * i + 1] = seen ? pixel.y : infinity;
    }
  }

  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override {
    const Scene s = scene(values, group);
    const BoardsInput::View& view = input_.views[group];
    const Mat3 turn = left_jacobian(s.turn);
    const std::size_t rows = 2 * view.corners.size();
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      Vec2 pixel{0, 0};
      MovingJacobian j{};
      predict_moving(s.intrinsics, s.pose, s.extent, s.warp, s.readout, view.corners[i].board_m, pixel, j);
      for (std::size_t axis = 0; axis < 2; ++axis) {
        std::array<double, MovingColumn::count>& d = j[axis];
        const std::array<double, 3> w = {d[BoardColumn::rotation], d[BoardColumn::rotation + 1],
                                         d[BoardColumn::rotation + 2]};
        for (int k = 0; k < 3; ++k)
          d[BoardColumn::rotation + static_cast<std::size_t>(k)] =
              w[0] * turn(0, k) + w[1] * turn(1, k) + w[2] * turn(2, k);
        for (std::size_t k = 0; k < columns.size(); ++k) {
          const Role& role = roles_[columns[k]];
          const bool own = (role.camera == none || role.camera == view.camera) &&
                           (role.board == none || role.board == view.board) &&
                           (role.view == none || role.view == group);
          derivatives[k * rows + 2 * i + axis] = own ? d[role.column] : 0;
        }
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
      const auto find = [&](Vec2 at) {
        for (std::size_t k = 0; k < view.corners.size(); ++k)
          if (norm(view.corners[k].board_m - at) < 0.1 * square) return k;
        return none;
      };
      for (std::size_t i = 0; i < view.corners.size(); ++i)
        for (const Vec2 step : {Vec2{square, 0}, Vec2{0, square}}) {
          const std::size_t a = find(view.corners[i].board_m - step), b = find(view.corners[i].board_m + step);
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

  void apply(const Explanation& e, manifest::Document& document) const override {
    upgrade_boards(*this, input_, roles_, e, document);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_boards(input_, observations_, e);
  }

 private:
  using Role = BoardRole;
  struct Scene {
    camera::Intrinsics intrinsics;
    camera::BoardPose pose;
    camera::BoardExtent extent;
    camera::BoardWarp warp;
    Vec3 turn;
    Readout readout;
  };

  Scene scene(std::span<const double> values, std::size_t group) const {
    const BoardsInput::View& view = input_.views[group];
    const BoardsInput::Camera& camera = input_.cameras[view.camera];
    Scene s{camera.intrinsics,     {}, input_.boards[view.board].extent, input_.boards[view.board].warp, {},
            {camera.height_px, {}}};
    std::array<double, 6> change{};
    for (std::size_t p = 0; p < roles_.size(); ++p) {
      const Role& r = roles_[p];
      if (r.view == group && r.column < MovingColumn::motion) change[r.column - BoardColumn::rotation] = values[p];
      if (r.view == group && r.column >= MovingColumn::motion)
        (r.column == MovingColumn::motion ? s.readout.motion_m.x : s.readout.motion_m.y) = values[p];
      if (r.camera == view.camera) {
        if (r.column == 0) s.intrinsics.fx_px = values[p];
        if (r.column == 1) s.intrinsics.fy_px = values[p];
        if (r.column == 2) s.intrinsics.cx_px = values[p];
        if (r.column == 3) s.intrinsics.cy_px = values[p];
        if (r.column >= BoardColumn::distortion)
          s.intrinsics.distortion[r.column - BoardColumn::distortion] = values[p];
      }
      if (r.board == view.board) (r.column == BoardColumn::warp ? s.warp.sag_x_m : s.warp.sag_y_m) = values[p];
    }
    s.turn = {change[0], change[1], change[2]};
    s.pose = camera::moved(view.camera_from_board, change);
    return s;
  }

  std::size_t declare(Parameter parameter, Role role) {
    parameters_.push_back(std::move(parameter));
    roles_.push_back(role);
    return parameters_.size() - 1;
  }
  // Groups that a camera or a board takes part in; empty where that is all of them.
  template <class Same>
  std::vector<std::size_t> groups_where(Same same) const {
    std::vector<std::size_t> groups;
    for (std::size_t v = 0; v < input_.views.size(); ++v)
      if (same(input_.views[v])) groups.push_back(v);
    return groups.size() == input_.views.size() ? std::vector<std::size_t>{} : groups;
  }
  std::vector<std::size_t> groups_of_camera(std::size_t c) const {
    return groups_where([&](const BoardsInput::View& v) { return v.camera == c; });
  }

  void declare_camera(std::size_t c) {
    const BoardsInput::Camera& own = input_.cameras[c];
    const camera::Intrinsics& k = own.intrinsics;
    const std::array<double, 4> start = {k.fx_px, k.fy_px, k.cx_px, k.cy_px};
    const std::string prefix = "cameras/" + own.name + "/";
    for (std::size_t i = 0; i < 4; ++i) {
      const double lower = i < 2 ? 0.2 * start[i] : -infinity, upper = i < 2 ? 5 * start[i] : infinity;
      base_.push_back(
          declare({prefix + intrinsic_names[i], "px", start[i], start[i], lower, upper, 1, {}, groups_of_camera(c)},
                  {c, none, none, i}));
    }
    for (const std::size_t t : own.terms)
      base_.push_back(declare({prefix + std::string(camera::distortion_names[t]),
                               "1",
                               k.distortion[t],
                               k.distortion[t],
                               -infinity,
                               infinity,
                               0.01,
                               {},
                               groups_of_camera(c)},
                              {c, none, none, BoardColumn::distortion + t}));
  }

  void declare_board(std::size_t b) {
    if (!input_.boards[b].warped) return;
    const camera::BoardWarp& warp = input_.boards[b].warp;
    const auto groups = groups_where([&](const BoardsInput::View& v) { return v.board == b; });
    const std::string prefix = "boards/" + input_.boards[b].name + "/";
    base_.push_back(
        declare({prefix + "sag_x_m", "m", warp.sag_x_m, warp.sag_x_m, -infinity, infinity, 1e-4, {}, groups},
                {none, b, none, BoardColumn::warp}));
    base_.push_back(
        declare({prefix + "sag_y_m", "m", warp.sag_y_m, warp.sag_y_m, -infinity, infinity, 1e-4, {}, groups},
                {none, b, none, BoardColumn::warp + 1}));
  }

  void declare_view(std::size_t v) {
    for (std::size_t i = 0; i < 6; ++i)
      base_.push_back(declare(
          {input_.views[v].image + "/" + pose_names[i], i < 3 ? "rad" : "m", 0, 0, -infinity, infinity, 1e-3, {}, {v}},
          {none, none, v, BoardColumn::rotation + i}));
  }

  // lens.rational and lens.fisheye say how lens.radial falls short: over a moderate field all three bow lines alike,
  // and the plain one is to be named first. An equidistant lens has neither of them: its term is at the end of the
  // range, and the denominators have faded.
  static bool describes_radius(const BoardsInput::Camera& camera, const mechanism::Parameter& p, std::size_t term) {
    const std::array<double, camera::distortion_terms>& lens = camera.intrinsics.distortion;
    const bool radial = std::find(camera.terms.begin(), camera.terms.end(), camera::LensTerm::k1) != camera.terms.end();
    return radial && lens[term] == p.neutral && lens[camera::LensTerm::fisheye] < 1;
  }

  void declare_lens(const std::string& id) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    if (m == nullptr) throw Error(Exit::internal, "explain", "mechanism " + id + " is not registered");
    Candidate candidate{m, {}, {}, {}};
    const bool finer = id == "lens.rational" || id == "lens.fisheye";
    for (std::size_t c = 0; c < input_.cameras.size(); ++c) {
      const BoardsInput::Camera& own = input_.cameras[c];
      bool lacking = false;
      for (const mechanism::Parameter& p : m->parameters) {
        const auto name = std::find(camera::distortion_names.begin(), camera::distortion_names.end(), p.name);
        const auto term = static_cast<std::size_t>(name - camera::distortion_names.begin());
        if (std::find(own.terms.begin(), own.terms.end(), term) != own.terms.end()) continue;
        if (finer && !describes_radius(own, p, term)) continue;
        lacking = true;
        const std::string prefix = input_.cameras.size() > 1 ? "cameras/" + own.name + "/" : id + ".";
        candidate.parameters.push_back(
            declare({prefix + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, 0.01, {}, groups_of_camera(c)},
                    {c, none, none, BoardColumn::distortion + term}));
      }
      if (lacking) candidate.on.push_back(own.name);
    }
    if (!candidate.parameters.empty()) candidates_.push_back(std::move(candidate));
  }

  void declare_warp() {
    const mechanism::Mechanism* m = mechanism::find_mechanism("board.warp");
    if (m == nullptr) throw Error(Exit::internal, "explain", "mechanism board.warp is not registered");
    Candidate candidate{m, {}, {}, {}};
    for (std::size_t b = 0; b < input_.boards.size(); ++b) {
      if (input_.boards[b].warped) continue;
      candidate.on.push_back(input_.boards[b].name);
      const auto groups = groups_where([&](const BoardsInput::View& v) { return v.board == b; });
      for (std::size_t k = 0; k < 2; ++k) {
        const mechanism::Parameter& p = m->parameters.at(k);
        const std::string prefix = input_.boards.size() > 1 ? "boards/" + input_.boards[b].name + "/" : "board.warp.";
        candidate.parameters.push_back(
            declare({prefix + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, 1e-4, {}, groups},
                    {none, b, none, BoardColumn::warp + k}));
      }
    }
    if (!candidate.parameters.empty()) candidates_.push_back(std::move(candidate));
  }

  // Every view has its own motion: nuisance like its pose, under one mechanism.
  void declare_rolling_shutter() {
    const mechanism::Mechanism* m = mechanism::find_mechanism("camera.rolling-shutter");
    if (m == nullptr) throw Error(Exit::internal, "explain", "mechanism camera.rolling-shutter is not registered");
    Candidate candidate{m, {}, {}, {}};
    for (const BoardsInput::Camera& c : input_.cameras) candidate.on.push_back(c.name);
    for (std::size_t v = 0; v < input_.views.size(); ++v)
      for (std::size_t k = 0; k < 2; ++k) {
        const mechanism::Parameter& p = m->parameters.at(k);
        candidate.parameters.push_back(
            declare({input_.views[v].image + "/" + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, 1e-4, {}, {v}},
                    {none, none, v, MovingColumn::motion + k}));
      }
    candidates_.push_back(std::move(candidate));
  }

  void observe() {
    Observations& o = observations_;
    o.first.push_back(0);
    o.conditions = board_conditions();
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
        append_conditions(input_.cameras[view.camera], input_.boards[view.board], view, corner, o.conditions);
      }
      o.first.push_back(o.value.size());
    }
  }

  BoardsInput input_;
  std::vector<Role> roles_;
};

}  // namespace

std::unique_ptr<Problem> boards_problem(BoardsInput input) {
  return std::make_unique<BoardsProblem>(std::move(input));
}

}  // namespace gonio::explain
