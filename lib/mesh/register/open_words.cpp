#include "mesh/register/open_words.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "linear/svd.h"

namespace gonio::mesh {
namespace {

constexpr double no_turn = 0.15;  // share of a unit motion that is a turn: the rest is what residuals blur

std::string direction(Eigen::Vector3d v) {
  int most = 0;
  v.cwiseAbs().maxCoeff(&most);
  if (v[most] < 0) v = -v;
  for (int k = 0; k < 3; ++k)
    if (std::abs(v[k]) < 0.005) v[k] = 0;
  return format("(%.2f, %.2f, %.2f)", v[0], v[1], v[2]);
}

std::string place(const Eigen::Vector3d& p) {
  return format("(%.4g, %.4g, %.4g) m", p[0], p[1], p[2]);
}

struct Turn {
  Eigen::Vector3d axis, at_centre;  // the velocity of the centre, slides taken out
};

// The place that turns about all of these axes would leave where it is: least |velocity + axis x (p - centre)|.
Eigen::Vector3d common_place(const std::vector<Turn>& turns, const Eigen::Vector3d& centre) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const Turn& t : turns) {
    a += t.axis.squaredNorm() * Eigen::Matrix3d::Identity() - t.axis * t.axis.transpose();
    b += linear::cross_matrix(t.axis) * t.at_centre;
  }
  a += 1e-9 * a.trace() * Eigen::Matrix3d::Identity();  // along the axis of a single turn: no step
  return centre + linear::solve_ldlt(Eigen::MatrixXd(a), Eigen::VectorXd(b));
}

}  // namespace

std::vector<std::string> open_words(const Eigen::MatrixXd& open, const MotionScale& scale) {
  if (open.cols() == 0) return {};
  if (open.cols() == 6) return {"every motion"};
  const Eigen::MatrixXd turning = open.topRows(3);
  const linear::JacobiSvd<Eigen::MatrixXd> parts(turning, Eigen::ComputeFullV);
  std::vector<Eigen::Vector3d> slides;
  std::vector<Turn> turns;
  for (Eigen::Index k = open.cols() - 1; k >= 0; --k) {
    const Eigen::VectorXd one = open * parts.matrixV().col(k);
    const bool slide = k >= parts.singularValues().size() || parts.singularValues()[k] < no_turn;
    if (slide) {
      slides.push_back(one.tail(3).normalized());
      continue;
    }
    Eigen::Vector3d velocity = one.tail(3);
    for (const Eigen::Vector3d& s : slides) velocity -= s * s.dot(velocity);
    turns.push_back({one.head(3) / scale.length_m, velocity});
  }
  std::vector<std::string> words;
  if (slides.size() == 1) words.push_back("sliding along " + direction(slides[0]));
  if (slides.size() == 2)
    words.push_back("sliding in the plane across " +
                    direction((linear::cross_matrix(slides[0]) * slides[1]).normalized()));
  if (slides.size() == 3) words.push_back("sliding anywhere");
  if (turns.empty()) return words;
  const Eigen::Vector3d at = common_place(turns, {scale.centre_m.x, scale.centre_m.y, scale.centre_m.z});
  if (turns.size() == 1)
    words.push_back("turning about the axis " + direction(turns[0].axis.normalized()) + " through " + place(at));
  if (turns.size() == 2)
    words.push_back("turning about every axis across " +
                    direction((linear::cross_matrix(turns[0].axis) * turns[1].axis).normalized()) + " through " +
                    place(at));
  if (turns.size() == 3) words.push_back("turning about every axis through " + place(at));
  return words;
}

}  // namespace gonio::mesh
