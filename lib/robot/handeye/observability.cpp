#include "robot/handeye/observability.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/random.h"
#include "linear/solve.h"
#include "linear/svd.h"
#include "linear/symmetric_eigen.h"
#include "robot/handeye/pose_adjustment.h"

namespace gonio::robot::handeye {
namespace {

constexpr int disturbances = 24;
constexpr double feigned_limit = 0.25;     // relative growth of a direction's information under the noise
constexpr double rounding_share = 1e-10;   // of the best determined direction's information
constexpr double part_of_direction = 0.2;  // a direction touches a block if this much of its length lies in it

using Basis12 = Eigen::Matrix<double, 12, Eigen::Dynamic>;

std::vector<ObservedPose> observed_poses(const Setup& setup, const std::vector<View>& views,
                                         const std::vector<bool>& counts, const Refined& refined) {
  std::vector<ObservedPose> list;
  const double s2 = refined.noise.corner * refined.noise.corner;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!counts[i]) continue;
    const CornerInformation c = corner_information(setup, views[i], views[i].camera_from_board, refined.noise.corner);
    list.push_back({views[i].base_from_tool, views[i].camera_from_board,
                    s2 * linear::solve_ldlt(c.information, Matrix6::Identity()), true, setup.middle_m()});
  }
  return list;
}

// The poses once more, each moved as the robot's and the camera's noise may have moved it.
std::vector<ObservedPose> disturbed(Kind kind, std::vector<ObservedPose> poses, const Refined& refined,
                                    Random& random) {
  for (ObservedPose& o : poses) {
    const Deviation d = deviation(kind, o, refined.solution);
    const Eigen::LLT<Matrix6> root(deviation_covariance(d, o, refined.noise));
    Vector6 normal;
    for (int k = 0; k < 6; ++k) normal(k) = random.normal();
    o.camera_from_board = moved_by(o.camera_from_board, d.by_pose.partialPivLu().solve(root.matrixL() * normal));
  }
  return poses;
}

// Columns of eigenvectors `chosen`.
Basis12 columns(const Matrix12& vectors, const std::vector<int>& chosen) {
  Basis12 basis(12, static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t k = 0; k < chosen.size(); ++k) basis.col(static_cast<Eigen::Index>(k)) = vectors.col(chosen[k]);
  return basis;
}

// Directions that the geometry of the poses leaves open, whatever the noise: a robot with equal noise in turns, at the
// board's distance, and shifts, and an exact camera.
Basis12 geometrically_free(const Setup& setup, std::vector<ObservedPose> poses, const Refined& refined, double reach) {
  for (ObservedPose& o : poses) o.covariance.setZero();
  Noise unit;
  unit.robot_m = 1;
  unit.robot_rad = 1 / reach;
  Vector12 scale;
  scale << Vector3::Constant(1 / reach), Vector3::Ones(), Vector3::Constant(1 / reach), Vector3::Ones();
  const Matrix12 n = scale.asDiagonal() * information(setup.kind, poses, refined.solution, unit) * scale.asDiagonal();
  const linear::SymmetricEigen<Matrix12> e(n);
  std::vector<int> free;
  for (int k = 0; k < 12; ++k) {
    if (e.eigenvalues()(k) < rounding_share * e.eigenvalues()(11)) free.push_back(k);
  }
  return columns(e.eigenvectors(), free);
}

// Lengths stand for turns as well: a turn by w counts as the shift w * reach at a typical distance.
Basis12 free_directions(const Setup& setup, const std::vector<ObservedPose>& poses, const Refined& refined,
                        double reach) {
  if (const Basis12 exact = geometrically_free(setup, poses, refined, reach); exact.cols() > 0) return exact;
  Vector12 unit;
  unit << Vector3::Constant(1 / reach), Vector3::Ones(), Vector3::Constant(1 / reach), Vector3::Ones();
  const auto at = [&](const std::vector<ObservedPose>& p) -> Matrix12 {
    return unit.asDiagonal() * information(setup.kind, p, refined.solution, refined.noise) * unit.asDiagonal();
  };
  const Matrix12 n = at(poses);
  Matrix12 more = Matrix12::Zero();
  Random random(24871);
  for (int k = 0; k < disturbances; ++k) more += at(disturbed(setup.kind, poses, refined, random)) / disturbances;
  const linear::SymmetricEigen<Matrix12> e(n);
  std::vector<int> free;
  for (int k = 0; k < 12; ++k) {
    const Vector12 v = e.eigenvectors().col(k);
    const double there = v.dot(n * v), then = v.dot(more * v);
    if (then - there > feigned_limit * there) free.push_back(k);
  }
  return columns(e.eigenvectors(), free);
}

// Directions of R^3 that a block of the basis reaches, strongest first.
std::vector<Vector3> reached(const Eigen::MatrixXd& block) {
  std::vector<Vector3> list;
  if (block.cols() == 0) return list;
  const linear::JacobiSvd<Eigen::MatrixXd> svd(block, Eigen::ComputeThinU);
  for (Eigen::Index k = 0; k < svd.singularValues().size(); ++k) {
    if (svd.singularValues()(k) > part_of_direction) list.push_back(svd.matrixU().col(k));
  }
  return list;
}

void say(const std::string& what, const std::vector<Vector3>& directions, const std::string& along,
         const std::string& frame, std::vector<std::string>& words) {
  if (directions.size() == 3) {
    words.push_back(what + " in " + frame + "'s frame, in every direction");
    return;
  }
  for (const Vector3& d : directions) words.push_back(what + " " + along + " " + direction_words(vec_of(d), frame));
}

}  // namespace

std::string direction_words(Vec3 d, const std::string& frame) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(d[k]) > std::cos(10 * pi / 180)) return frame + "'s " + std::string(1, "xyz"[k]) + " axis";
  }
  const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  const double first = std::abs(d.x) == largest ? d.x : std::abs(d.y) == largest ? d.y : d.z;
  if (first < 0) d = -d;
  char text[80];
  std::snprintf(text, sizeof text, "the direction (%.2f, %.2f, %.2f) of ", d.x, d.y, d.z);
  return text + frame + "'s axes";
}

Observability observe(const Setup& setup, const std::vector<View>& views, const std::vector<bool>& counts,
                      const Refined& refined) {
  const std::vector<ObservedPose> poses = observed_poses(setup, views, counts, refined);
  double reach = 0;
  for (const ObservedPose& o : poses)
    reach += norm(o.camera_from_board.translation_m) / static_cast<double>(poses.size());
  const Basis12 free = free_directions(setup, poses, refined, std::max(reach, 1e-6));
  Observability result;
  if (free.cols() == 0) return result;
  const bool in_hand = setup.kind == Kind::eye_in_hand;
  const std::string mount = in_hand ? "the tool" : "the base", stand = in_hand ? "the base" : "the tool";
  // First the turns, then the shifts that remain where nothing turns.
  Eigen::MatrixXd turns(6, free.cols());
  turns << free.topRows<3>(), free.middleRows<3>(6);
  const linear::JacobiSvd<Eigen::MatrixXd> svd(turns, Eigen::ComputeFullV);
  std::vector<Eigen::Index> still;
  for (Eigen::Index k = 0; k < free.cols(); ++k) {
    if (k >= svd.singularValues().size() || svd.singularValues()(k) < part_of_direction) still.push_back(k);
  }
  Basis12 shifts(12, static_cast<Eigen::Index>(still.size()));
  for (std::size_t k = 0; k < still.size(); ++k) {
    shifts.col(static_cast<Eigen::Index>(k)) = free * svd.matrixV().col(still[k]);
  }
  say("rotation of the camera", reached(free.topRows<3>()), "about", mount, result.unobservable);
  say("rotation of the board", reached(free.middleRows<3>(6)), "about", stand, result.unobservable);
  say("translation of the camera", reached(shifts.middleRows<3>(3)), "along", mount, result.unobservable);
  say("translation of the board", reached(shifts.bottomRows<3>()), "along", stand, result.unobservable);
  result.mount_from_camera = free.topRows<6>().norm() < part_of_direction;
  result.stand_from_board = free.bottomRows<6>().norm() < part_of_direction;
  if (result.unobservable.empty()) result.unobservable.push_back("a turn of camera and board together");
  return result;
}

}  // namespace gonio::robot::handeye
