// See singularity.h.
#include "robot/inverse/singularity.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "geom/angle.h"
#include "linear/svd.h"

namespace gonio::robot {
namespace {

Eigen::MatrixXd flange_jacobian(std::span<const Link> links, const Joints& joints_rad, double length_m) {
  const std::vector<Motion> motions = joint_motions(links, joints_rad);
  Eigen::MatrixXd j(6, static_cast<Eigen::Index>(motions.size()));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Vec3 shift = motions[i].shift_m, turn = motions[i].turn_rad * length_m;
    j.col(static_cast<Eigen::Index>(i)) << shift.x, shift.y, shift.z, turn.x, turn.y, turn.z;
  }
  return j;
}

double degrees_of_sine(double sine) {
  return std::asin(std::min(1.0, std::abs(sine))) / degree;
}

// Without names: the joints that make up the motion which moves the flange least.
std::string joints_that_cancel(const std::array<double, 6>& worst) {
  std::string words;
  for (std::size_t i = 0; i < 6; ++i)
    if (std::abs(worst[i]) > 0.3) words += format("%s%zu", words.empty() ? "joints " : ", ", i + 1);
  return words + " all but cancel each other";
}

}  // namespace

double smallest_singular_m(std::span<const Link> links, const Joints& joints_rad, double length_m) {
  return linear::JacobiSvd<Eigen::MatrixXd>(flange_jacobian(links, joints_rad, length_m)).singularValues()[5];
}

Dexterity dexterity_at(const InverseKinematics& inverse, std::span<const Link> links, const Joints& joints_rad,
                       double length_m) {
  const linear::JacobiSvd<Eigen::MatrixXd> svd(flange_jacobian(links, joints_rad, length_m), Eigen::ComputeFullV);
  Dexterity d;
  d.smallest_m = svd.singularValues()[5], d.largest_m = svd.singularValues()[0];
  for (std::size_t i = 0; i < 6; ++i) d.worst[i] = svd.matrixV()(static_cast<Eigen::Index>(i), 5);
  const std::optional<SingularFactors> factors = inverse.factors_at(joints_rad);
  if (!factors) {
    d.words = joints_that_cancel(d.worst);
    return d;
  }
  double reach_m = 0;
  for (const Link& link : links) reach_m += std::abs(link.a_m);  // what the shoulder's distance is compared with
  const bool spherical = inverse.family() == Family::spherical_wrist;
  const double shoulder = std::abs(factors->shoulder_m) / reach_m;
  const double elbow = std::abs(factors->elbow), wrist = std::abs(factors->wrist);
  if (wrist <= std::min(shoulder, elbow)) {
    d.nearest = Singular::wrist;
    d.words = format("wrist: axis 6 is %.1f deg from %s", degrees_of_sine(wrist),
                     spherical ? "in line with axis 4" : "parallel to axes 2, 3, 4");
  } else if (elbow <= shoulder) {
    d.nearest = Singular::elbow;
    d.words = format("elbow: %.1f deg from stretched or folded", degrees_of_sine(elbow));
  } else {
    d.nearest = Singular::shoulder;
    d.words = format("shoulder: the wrist's centre is %.0f mm from %s", std::abs(factors->shoulder_m) * 1e3,
                     "the plane of axis 1 and axis 2's direction");
  }
  return d;
}

}  // namespace gonio::robot
