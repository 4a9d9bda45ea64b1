// The normal equations, view by view.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "camera/bundle_adjustment.h"
#include "camera/carried_corners.h"
#include "linear/solve.h"

namespace gonio::camera {
namespace {

using Kind = SharedParameter::Kind;
using Matrix = Eigen::MatrixXd;
using Pose6 = Eigen::Matrix<double, 6, 6>;
using Row = std::array<double, BoardColumn::count>;

constexpr double unseen_px = 1000;  // what a corner costs that the lens does not show
constexpr std::array<const char*, 6> motion_names = {"rotation_x_rad",  "rotation_y_rad",  "rotation_z_rad",
                                                     "translation_x_m", "translation_y_m", "translation_z_m"};

bool acts_on(const FreeParameter& parameter, const View& view) {
  return parameter.what.of == (parameter.what.kind == Kind::board ? view.board : view.camera);
}

// A view's derivatives with respect to camera_from_rig and rig_from_board, from those with respect to
// camera_from_board (all as changes on the left): it turns by w + R w' and moves by w x (R t') + d + R d'.
struct Chain {
  Mat3 back;      // R'
  Vec3 offset_m;  // R t'

  std::array<double, 12> operator()(const Row& row) const {
    const Vec3 turn{row[BoardColumn::rotation], row[BoardColumn::rotation + 1], row[BoardColumn::rotation + 2]};
    const Vec3 shift{row[BoardColumn::translation], row[BoardColumn::translation + 1],
                     row[BoardColumn::translation + 2]};
    const Vec3 rig_turn = turn + cross(offset_m, shift), placed_turn = back * turn, placed_shift = back * shift;
    return {rig_turn.x,    rig_turn.y,    rig_turn.z,    shift.x,        shift.y,        shift.z,
            placed_turn.x, placed_turn.y, placed_turn.z, placed_shift.x, placed_shift.y, placed_shift.z};
  }
};

double directional(const FreeParameter& parameter, const Row& row, const std::array<double, 12>& motion) {
  double sum = 0;
  for (const auto& [column, factor] : parameter.columns) {
    sum += factor * (parameter.what.kind == Kind::rig ? motion[column] : row[column]);
  }
  return sum;
}

// How a view's predicted corners move: with the shared numbers that act on it or on the views that carry it, and with
// the board's place, which all of them share.
struct ViewMotion {
  ViewMotion(const std::vector<View>& views, std::size_t index, const CalibrationSetup& setup, const Adjustment& state)
      : view(views[index]),
        board(setup.boards[view.board].board),
        extent(board.extent()),
        lens(state.lenses[view.camera]),
        warp(state.warps[view.board]) {
    const CameraFromRig& rig = state.camera_from_rig[view.camera];
    const PlacedBoard& placed = state.placements[state.placement_of[index]];
    chain = {transposed(matrix_of(rig.rotation)), rig.rotate(placed.translation_m)};
    pose = rig * placed;
  }

  // Adds factor times the derivatives of corner k, columns [acting, six of the placement], to `rows` and takes factor
  // times its residual from `r`; false where the lens does not show it.
  bool add(std::size_t k, const Eigen::Matrix2d& factor, const std::vector<const FreeParameter*>& acting,
           Eigen::Matrix2Xd& rows, Eigen::Vector2d& r) const {
    Vec2 pixel;
    std::array<Row, 2> derivatives{};
    const Corner& corner = view.corners[k];
    if (!predict(lens, pose, extent, warp, board.corner_m(corner.id), pixel, derivatives)) return false;
    const auto m = static_cast<Eigen::Index>(acting.size());
    Eigen::Matrix2Xd own = Eigen::Matrix2Xd::Zero(2, m + 6);
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const Row& row = derivatives[static_cast<std::size_t>(axis)];
      const std::array<double, 12> motion = chain(row);
      for (Eigen::Index p = 0; p < m; ++p) {
        const FreeParameter& parameter = *acting[static_cast<std::size_t>(p)];
        if (acts_on(parameter, view)) own(axis, p) = directional(parameter, row, motion);
      }
      for (Eigen::Index p = 0; p < 6; ++p) own(axis, m + p) = motion[static_cast<std::size_t>(6 + p)];
    }
    rows += factor * own;
    r += factor * Eigen::Vector2d(corner.pixel.x - pixel.x, corner.pixel.y - pixel.y);
    return true;
  }

  const View& view;
  const Board& board;
  BoardExtent extent;
  const Intrinsics& lens;
  const BoardWarp& warp;
  Chain chain;
  BoardPose pose;
};

// Adds one view: its Jacobian, columns [shared that act on it, six of the placement, residual], rows weighted.
void add_view(const std::vector<View>& views, std::size_t index, const CalibrationSetup& setup,
              const std::vector<FreeParameter>& free, const Adjustment& state, NormalEquations& n) {
  const View& view = views[index];
  const Carriers carriers(views, index);
  const ViewMotion own(views, index, setup, state);
  std::vector<std::optional<ViewMotion>> carrying(views.size());
  for (const std::size_t v : carriers.views()) carrying[v].emplace(views, v, setup, state);
  std::vector<const FreeParameter*> acting;
  for (const FreeParameter& parameter : free)
    if (acts_on(parameter, view) ||
        std::ranges::any_of(carriers.views(), [&](std::size_t v) { return acts_on(parameter, views[v]); }))
      acting.push_back(&parameter);
  const auto m = static_cast<Eigen::Index>(acting.size());
  Matrix j(m + 7, 2 * static_cast<Eigen::Index>(view.corners.size()));  // transposed: a corner's row is a column
  Eigen::Index rows = 0;
  for (std::size_t k = 0; k < view.corners.size(); ++k) {
    const double weight = state.view_weights[index] * state.precision[index][k];
    Eigen::Matrix2Xd d = Eigen::Matrix2Xd::Zero(2, m + 6);
    Eigen::Vector2d r(0, 0);
    const Eigen::Matrix2d whitening = carriers.whitening(k);
    bool seen = own.add(k, whitening, acting, d, r);
    for (const CarriedFrom& from : carriers.of(k))
      seen = seen && carrying[from.view]->add(from.corner, -whitening * from.slope, acting, d, r);
    if (!seen) {
      n.cost += state.loss_px * (2 * unseen_px - state.loss_px);
      continue;
    }
    const double size = std::sqrt(weight) * r.norm();
    const double robust = size > state.loss_px ? state.loss_px / size : 1;
    n.cost += size > state.loss_px ? state.loss_px * (2 * size - state.loss_px) : size * size;
    n.squares += robust * weight * r.squaredNorm();
    n.coordinates += 2 * robust;
    const double root = std::sqrt(robust * weight);
    for (Eigen::Index axis = 0; axis < 2; ++axis, ++rows) {
      j.col(rows).head(m + 6) = root * d.row(axis).transpose();
      j(m + 6, rows) = root * r(axis);
    }
  }
  const auto used = j.leftCols(rows);
  const Matrix gram = used * used.transpose();
  const std::size_t p = state.placement_of[index];
  for (Eigen::Index s = 0; s < m; ++s) {
    const auto to = acting[static_cast<std::size_t>(s)] - free.data();
    for (Eigen::Index t = 0; t < m; ++t) n.a(to, acting[static_cast<std::size_t>(t)] - free.data()) += gram(s, t);
    n.g(to) += gram(s, m + 6);
    n.b[p].row(to) += gram.block<1, 6>(s, m);
  }
  n.c[p] += gram.block<6, 6>(m, m);
  n.h[p] += gram.block<6, 1>(m, m + 6);
}

void add_lens(const CameraSetup& camera, std::size_t index, const Intrinsics& lens, std::vector<FreeParameter>& free) {
  const auto held = [&](const std::string& name) { return camera.fixed.contains(name); };
  if (held("intrinsics")) return;
  const auto add = [&](const std::string& name, std::vector<std::pair<std::size_t, double>> columns) {
    free.push_back({{Kind::lens, index, name}, std::move(columns)});
  };
  if (held("aspect")) {
    add("fx_px", {{0, 1.0}, {1, lens.fy_px / lens.fx_px}});
  } else {
    add("fx_px", {{0, 1.0}});
    add("fy_px", {{1, 1.0}});
  }
  if (!held("principal-point")) {
    add("cx_px", {{2, 1.0}});
    add("cy_px", {{3, 1.0}});
  }
  if (held("distortion")) return;
  const TermSet& fitted = camera_model_info(camera.model, "calibration").fitted;
  for (std::size_t i = 0; i < distortion_terms; ++i) {
    const std::string name(distortion_names[i]);
    if (fitted.has(i) && !held(name)) add(name, {{BoardColumn::distortion + i, 1.0}});
  }
}

}  // namespace

std::vector<std::string> fixable_terms() {
  std::vector<std::string> names{"intrinsics", "distortion", "aspect", "principal-point"};
  for (std::size_t i = 0; i < LensTerm::fisheye; ++i) names.emplace_back(distortion_names[i]);
  return names;
}

std::vector<FreeParameter> free_parameters(const CalibrationSetup& setup, const Adjustment& state, bool all_warps) {
  std::vector<FreeParameter> free;
  for (std::size_t c = 0; c < setup.cameras.size(); ++c) add_lens(setup.cameras[c], c, state.lenses[c], free);
  for (std::size_t c = 0; c < setup.cameras.size(); ++c) {
    if (!state.tied[c]) continue;
    for (std::size_t i = 0; i < 6; ++i) free.push_back({{Kind::rig, c, motion_names[i]}, {{i, 1.0}}});
  }
  for (std::size_t b = 0; b < setup.boards.size(); ++b) {
    if (!setup.boards[b].free_warp && !all_warps) continue;
    free.push_back({{Kind::board, b, "sag_x_m"}, {{BoardColumn::warp, 1.0}}});
    free.push_back({{Kind::board, b, "sag_y_m"}, {{BoardColumn::warp + 1, 1.0}}});
  }
  return free;
}

NormalEquations normal_equations(const std::vector<View>& views, const CalibrationSetup& setup,
                                 const std::vector<FreeParameter>& free, const Adjustment& state) {
  const auto k = static_cast<Eigen::Index>(free.size());
  const std::size_t placements = state.placements.size();
  NormalEquations n{.a = Matrix::Zero(k, k),
                    .g = Eigen::VectorXd::Zero(k),
                    .b = std::vector<Matrix>(placements, Matrix::Zero(k, 6)),
                    .c = std::vector<Pose6>(placements, Pose6::Zero()),
                    .h = std::vector<Eigen::Matrix<double, 6, 1>>(placements, Eigen::Matrix<double, 6, 1>::Zero())};
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] > 0) add_view(views, i, setup, free, state, n);
  }
  return n;
}

Eigen::MatrixXd schur_complement(const NormalEquations& n) {
  Matrix s = n.a;
  for (std::size_t p = 0; p < n.c.size(); ++p) {
    if (n.c[p](0, 0) > 0) s.noalias() -= n.b[p] * linear::solve_ldlt(n.c[p], n.b[p].transpose());
  }
  return 0.5 * (s + s.transpose());
}

std::vector<Vec2> residuals(const View& view, const CalibrationSetup& setup, const Adjustment& state,
                            std::size_t index) {
  const Board& board = setup.boards[view.board].board;
  const BoardPose pose = state.pose(view, index);
  std::vector<Vec2> result;
  for (const Corner& corner : view.corners) {
    Vec2 pixel{HUGE_VAL, HUGE_VAL};
    predict(state.lenses[view.camera], pose, board.extent(), state.warps[view.board], board.corner_m(corner.id), pixel);
    result.push_back(corner.pixel - pixel);
  }
  return result;
}

}  // namespace gonio::camera
