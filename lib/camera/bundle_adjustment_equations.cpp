// The normal equations, view by view.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "camera/bundle_adjustment.h"
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

// Adds one view: its Jacobian, columns [shared that act on it, six of the placement, residual], rows weighted.
void add_view(const View& view, std::size_t index, const BoardSetup& board, const std::vector<FreeParameter>& free,
              const Adjustment& state, NormalEquations& n) {
  std::vector<std::size_t> acting;
  for (std::size_t p = 0; p < free.size(); ++p) {
    if (acts_on(free[p], view)) acting.push_back(p);
  }
  const auto m = static_cast<Eigen::Index>(acting.size());
  const CameraFromRig& rig = state.camera_from_rig[view.camera];
  const PlacedBoard& placed = state.placements[state.placement_of[index]];
  const Chain chain{transposed(matrix_of(rig.rotation)), rig.rotate(placed.translation_m)};
  const BoardPose pose = rig * placed;
  const BoardExtent extent = board.board.extent();
  Matrix j(m + 7, 2 * static_cast<Eigen::Index>(view.corners.size()));  // transposed: a corner's row is a column
  Eigen::Index rows = 0;
  std::array<Row, 2> derivatives{};
  for (std::size_t k = 0; k < view.corners.size(); ++k) {
    const Corner& corner = view.corners[k];
    const double weight = state.view_weights[index] * state.precision[index][k];
    Vec2 pixel;
    if (!predict(state.lenses[view.camera], pose, extent, state.warps[view.board], board.board.corner_m(corner.id),
                 pixel, derivatives)) {
      n.cost += state.loss_px * (2 * unseen_px - state.loss_px);
      continue;
    }
    const Vec2 r = corner.pixel - pixel;
    const double size = std::sqrt(weight) * norm(r);
    const double robust = size > state.loss_px ? state.loss_px / size : 1;
    n.cost += size > state.loss_px ? state.loss_px * (2 * size - state.loss_px) : size * size;
    n.squares += robust * weight * dot(r, r);
    n.coordinates += 2 * robust;
    const double root = std::sqrt(robust * weight);
    for (std::size_t axis = 0; axis < 2; ++axis, ++rows) {
      const std::array<double, 12> motion = chain(derivatives[axis]);
      for (Eigen::Index p = 0; p < m; ++p) {
        j(p, rows) = root * directional(free[acting[static_cast<std::size_t>(p)]], derivatives[axis], motion);
      }
      for (Eigen::Index p = 0; p < 6; ++p) j(m + p, rows) = root * motion[static_cast<std::size_t>(6 + p)];
      j(m + 6, rows) = root * (axis == 0 ? r.x : r.y);
    }
  }
  const auto used = j.leftCols(rows);
  const Matrix gram = used * used.transpose();
  const std::size_t p = state.placement_of[index];
  for (Eigen::Index s = 0; s < m; ++s) {
    const auto to = static_cast<Eigen::Index>(acting[static_cast<std::size_t>(s)]);
    for (Eigen::Index t = 0; t < m; ++t) {
      n.a(to, static_cast<Eigen::Index>(acting[static_cast<std::size_t>(t)])) += gram(s, t);
    }
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
    if (state.view_weights[i] > 0) add_view(views[i], i, setup.boards[views[i].board], free, state, n);
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
