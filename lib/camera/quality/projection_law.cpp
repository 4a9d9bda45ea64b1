// See projection_law.h.
#include "camera/quality/projection_law.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "camera/quality/linear_law.h"
#include "linear/solve.h"
#include "stats/distributions.h"

namespace gonio::camera {
namespace {

using Matrix36 = Eigen::Matrix<double, 3, 6>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Jacobian = std::array<std::array<double, BoardColumn::count>, 2>;
constexpr std::size_t no_board = static_cast<std::size_t>(-1);

Eigen::RowVectorXd along(const std::vector<Direction>& columns, const std::array<double, BoardColumn::count>& row) {
  Eigen::RowVectorXd g = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (const auto& [column, factor] : columns[k]) g[static_cast<Eigen::Index>(k)] += factor * row[column];
  return g;
}

// What a small rigid motion [rotation; shift] does to a point: rotation x arm + shift.
Matrix36 moves(Vec3 arm) {
  Matrix36 k;
  k << 0, arm.z, -arm.y, 1, 0, 0,  //
      -arm.z, 0, arm.x, 0, 1, 0,   //
      arm.y, -arm.x, 0, 0, 0, 1;
  return k;
}

Eigen::Matrix3d crossing(Vec3 v) {
  return Eigen::Matrix3d{{0, -v.z, v.y}, {v.z, 0, -v.x}, {-v.y, v.x, 0}};
}

// How a view's camera_from_board follows the shared numbers, and its covariance at given ones: the placement's, turned
// into the camera's frame, and the camera's own motion in its rig.
struct PoseLaw {
  Eigen::MatrixXd slope;  // 6 x shared
  Matrix6 own;
};
PoseLaw pose_law(const CameraResult& camera, std::size_t view) {
  const Calibration& c = camera.calibration;
  const auto k = static_cast<Eigen::Index>(c.shared.size());
  const Placement& placed = c.placements[c.views[view].placement];
  const auto camera_from_rig = inverse(c.cameras[camera.camera].rig_from_camera);
  const Mat3 turn = matrix_of(camera_from_rig.rotation);
  const Eigen::Matrix3d r = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(turn.m.data());
  Matrix6 by_placement = Matrix6::Zero(), by_camera = Matrix6::Identity();
  by_placement.block<3, 3>(0, 0) = by_placement.block<3, 3>(3, 3) = r;
  by_camera.block<3, 3>(3, 0) = -crossing(camera_from_rig.rotate(placed.rig_from_board.translation_m));
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  PoseLaw law{by_placement * Eigen::Map<const Rows>(placed.slope.data(), 6, k), Matrix6::Zero()};
  law.own = by_placement * Eigen::Map<const Matrix6>(placed.own.data()) * by_placement.transpose();
  Eigen::Index next = 0;
  for (Eigen::Index p = 0; p < k; ++p) {
    const SharedParameter& shared = c.shared[static_cast<std::size_t>(p)];
    if (shared.kind == SharedParameter::Kind::rig && shared.of == camera.camera)
      law.slope.col(p) += by_camera.col(next++);
  }
  return law;
}

}  // namespace

double radius_95(const PixelCovariance& c) {
  const double trace = c.trace(), squares = c.uu * c.uu + 2 * c.uv * c.uv + c.vv * c.vv;
  if (!(trace > 0)) return 0;
  // The quantile between one and two degrees, over the degrees, is smooth: a table every sixteenth.
  static const std::vector<double> table = [] {
    std::vector<double> t;
    for (int k = 0; k <= 16; ++k) t.push_back(stats::chi2_quantile(0.95, 1 + k / 16.0));
    return t;
  }();
  const double place = 16 * (std::clamp(trace * trace / squares, 1.0, 2.0) - 1);
  const auto low = std::min<std::size_t>(15, static_cast<std::size_t>(place));
  const double share = place - static_cast<double>(low);
  return std::sqrt(squares / trace * ((1 - share) * table[low] + share * table[low + 1]));
}

std::vector<Direction> directions(const CameraResult& camera, std::size_t board) {
  const std::vector<SharedParameter>& shared = camera.calibration.shared;
  const auto is_lens = [&](const SharedParameter& p) {
    return p.kind == SharedParameter::Kind::lens && p.of == camera.camera;
  };
  const bool aspect_held =
      std::ranges::none_of(shared, [&](const SharedParameter& p) { return is_lens(p) && p.name == "fy_px"; });
  std::vector<Direction> result;
  for (const SharedParameter& p : shared) {
    Direction& direction = result.emplace_back();
    if (p.kind == SharedParameter::Kind::board && p.of == board)
      direction.emplace_back(BoardColumn::warp + (p.name == "sag_y_m" ? 1 : 0), 1.0);
    if (!is_lens(p)) continue;
    if (p.name == "fx_px") {
      direction.emplace_back(0, 1.0);
      if (aspect_held) direction.emplace_back(1, camera.lens().fy_px / camera.lens().fx_px);
    } else if (p.name == "fy_px" || p.name == "cx_px" || p.name == "cy_px") {
      direction.emplace_back(p.name == "fy_px" ? 1u : p.name == "cx_px" ? 2u : 3u, 1.0);
    } else {
      direction.emplace_back(BoardColumn::distortion + distortion_index(p.name, "calibration"), 1.0);
    }
  }
  return result;
}

void add_warp(const std::vector<SharedParameter>& shared, std::size_t board, const AlignmentPart& part,
              Eigen::MatrixXd& by_shared) {
  for (std::size_t p = 0; p < shared.size(); ++p) {
    if (shared[p].kind != SharedParameter::Kind::board || shared[p].of != board) continue;
    by_shared.col(static_cast<Eigen::Index>(p)) += part.by_warp.col(shared[p].name == "sag_y_m" ? 1 : 0);
  }
}

AlignmentPart alignment_part(const Board& board, const BoardPose& pose, const BoardWarp& warp,
                             const std::vector<Vec2>& points) {
  const BoardExtent extent = board.extent();
  const std::array sag{warp.sag_x_m, warp.sag_y_m};
  const std::array<double, 2> one_x{1, 0}, one_y{0, 1};
  const Vec3 normal = pose.rotate({0, 0, 1});
  const Eigen::Vector3d lift(normal.x, normal.y, normal.z);
  AlignmentPart part{Matrix6::Zero(), Matrix6::Zero(), Eigen::Matrix<double, 6, 2>::Zero()};
  for (const Vec2 at : points) {
    const Vec3 arm = pose.rotate({at.x, at.y, board_height(extent, at, sag.data())});
    const Matrix36 whole = moves(arm + pose.translation_m);
    part.normal += whole.transpose() * whole;
    part.by_pose += whole.transpose() * moves(arm);
    part.by_warp.col(0) += whole.transpose() * lift * board_height(extent, at, one_x.data());
    part.by_warp.col(1) += whole.transpose() * lift * board_height(extent, at, one_y.data());
  }
  return part;
}

ViewEquations view_equations(const Intrinsics& lens, const BoardPose& pose, const Board& board, const BoardWarp& warp,
                             const std::vector<Direction>& columns, const std::vector<Vec2>& points,
                             const std::vector<double>& weights) {
  const auto k = static_cast<Eigen::Index>(columns.size());
  ViewEquations e{Eigen::MatrixXd::Zero(k, k), Eigen::MatrixXd::Zero(k, 6), Matrix6::Zero()};
  Jacobian j{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec2 pixel;
    if (!predict(lens, pose, board.extent(), warp, points[i], pixel, j)) continue;
    for (const auto& row : j) {
      const Eigen::RowVectorXd g = along(columns, row);
      const Eigen::Map<const Eigen::Matrix<double, 1, 6>> h(row.data() + BoardColumn::rotation);
      e.a.noalias() += weights[i] * g.transpose() * g;
      e.b.noalias() += weights[i] * g.transpose() * h;
      e.c.noalias() += weights[i] * h.transpose() * h;
    }
  }
  return e;
}

bool pixel_derivatives(const Intrinsics& lens, const LinearLaw& law, Vec3 point, bool infinitely_far,
                       PixelDerivatives& d) {
  Jacobian j{};
  Vec2 pixel;
  const Vec3 at = infinitely_far ? point * (1 / norm(point)) : point;
  if (!predict(lens, {{}, at}, {}, {}, {0, 0}, pixel, j)) return false;
  const auto k = static_cast<Eigen::Index>(law.columns.size());
  d.by_shared = Eigen::MatrixXd::Zero(2, k);
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    auto row = j[static_cast<std::size_t>(axis)];
    row[BoardColumn::warp] = row[BoardColumn::warp + 1] = 0;  // the point is none of the board's
    d.by_shared.row(axis) = along(law.columns, row);
    const Eigen::Map<const Eigen::Matrix<double, 1, 3>> by_point(row.data() + BoardColumn::translation);
    d.by_motion.row(axis) = by_point * moves(at);
  }
  if (infinitely_far) d.by_motion.rightCols<3>().setZero();
  d.by_shared += d.by_motion * law.drift;
  return true;
}

ProjectionLaw::ProjectionLaw(const CameraResult& camera) : lens_(camera.lens()) {
  const Calibration& c = camera.calibration;
  if (c.covariance.empty()) throw Error(Exit::internal, "projection law", "the calibration has no covariance");
  LinearLaw law;
  law.columns = directions(camera, no_board);
  const auto k = static_cast<Eigen::Index>(c.shared.size());
  law.shared = Eigen::Map<const Eigen::MatrixXd>(c.covariance.data(), k, k);
  law.normal = Matrix6::Zero();
  Eigen::MatrixXd by_shared = Eigen::MatrixXd::Zero(6, k);
  Matrix6 by_noise = Matrix6::Zero();
  for (std::size_t i = 0; i < camera.views.size(); ++i) {
    if (!camera.uses(i)) continue;
    std::vector<Vec2> points;
    for (const Corner& corner : camera.views[i].corners) points.push_back(camera.board(i).corner_m(corner.id));
    const AlignmentPart part = alignment_part(camera.board(i), c.views[i].camera_from_board, camera.warp(i), points);
    const PoseLaw pose = pose_law(camera, i);
    law.normal += part.normal;
    by_shared += part.by_pose * pose.slope;
    by_noise += part.by_pose * pose.own * part.by_pose.transpose();
    add_warp(c.shared, camera.views[i].board, part, by_shared);
  }
  const linear::Ldlt normal(law.normal);
  law.drift = normal.solve(by_shared);
  law.scatter = normal.solve(Matrix6(normal.solve(by_noise).transpose()));
  linear_ = std::make_shared<const LinearLaw>(std::move(law));
}

std::optional<PixelCovariance> ProjectionLaw::at(Vec3 point, bool infinitely_far) const {
  PixelDerivatives d;
  if (!pixel_derivatives(lens_, *linear_, point, infinitely_far, d)) return std::nullopt;
  const Eigen::Matrix2d c = d.by_shared * linear_->shared * d.by_shared.transpose() +
                            d.by_motion * linear_->scatter * d.by_motion.transpose();
  return PixelCovariance{c(0, 0), 0.5 * (c(0, 1) + c(1, 0)), c(1, 1)};
}

}  // namespace gonio::camera
