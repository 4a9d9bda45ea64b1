// See alignment.h.
#include "camera/quality/alignment.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "linear/svd.h"

namespace gonio::camera {
namespace {

constexpr int most_steps = 30;

}  // namespace

Rigid<frame::Camera, frame::Camera> aligned(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  Eigen::Vector3d mean_from = Eigen::Vector3d::Zero(), mean_to = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i)
    mean_from += linear::as_eigen(from[i]), mean_to += linear::as_eigen(to[i]);
  mean_from /= static_cast<double>(from.size());
  mean_to /= static_cast<double>(from.size());
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i)
    sum += (linear::as_eigen(to[i]) - mean_to) * (linear::as_eigen(from[i]) - mean_from).transpose();
  const linear::JacobiSvd<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  mirror(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Eigen::Matrix3d r = svd.matrixU() * mirror * svd.matrixV().transpose();
  const Eigen::Vector3d t = mean_to - r * mean_from;
  return {quaternion_of(linear::mat3_of(r)), {t.x(), t.y(), t.z()}};
}

BoardPose pose_under(const View& view, const Board& board, const Intrinsics& lens, const BoardWarp& warp,
                     BoardPose pose, double loss_px) {
  std::array<std::array<double, BoardColumn::count>, 2> j{};
  for (int step = 0; step < most_steps; ++step) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    for (const Corner& corner : view.corners) {
      Vec2 pixel;
      if (!predict(lens, pose, board.extent(), warp, board.corner_m(corner.id), pixel, j)) continue;
      const Vec2 r = corner.pixel - pixel;
      const double size = norm(r), weight = size > loss_px ? loss_px / size : 1;
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const Eigen::Map<const Eigen::Matrix<double, 6, 1>> h(j[axis].data() + BoardColumn::rotation);
        normal += weight * h * h.transpose();
        gradient += weight * (axis == 0 ? r.x : r.y) * h;
      }
    }
    const Eigen::Matrix<double, 6, 1> change = linear::solve_ldlt(normal, gradient);
    if (!change.allFinite()) break;
    pose = moved(pose, {change[0], change[1], change[2], change[3], change[4], change[5]});
    if (change.head<3>().norm() < 1e-10 && change.tail<3>().norm() < 1e-10) break;
  }
  return pose;
}

void append_points(const View& view, const Board& board, const BoardWarp& warp, const BoardPose& pose,
                   std::vector<Vec3>& points) {
  const BoardExtent extent = board.extent();
  const std::array sag{warp.sag_x_m, warp.sag_y_m};
  for (const Corner& corner : view.corners) {
    const Vec2 at = board.corner_m(corner.id);
    points.push_back(pose * Vec3{at.x, at.y, board_height(extent, at, sag.data())});
  }
}

std::optional<Vec2> project(const Intrinsics& lens, Vec3 point) {
  Vec2 pixel;
  if (!predict(lens, {{}, point}, {}, {}, {0, 0}, pixel)) return std::nullopt;
  return pixel;
}

}  // namespace gonio::camera
