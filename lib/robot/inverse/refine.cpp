// See refine.h. Marquardt's damping, J scaled by the arm's size so that metres and radians count alike.
#include "robot/inverse/refine.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "optim/damped.h"

namespace gonio::robot::screws {
namespace {

using Six = Eigen::Matrix<double, 6, 1>;
using Square = Eigen::Matrix<double, 6, 6>;

Six column(Vec3 shift_m, Vec3 turn_rad, double size_m) {
  Six c;
  c << shift_m.x / size_m, shift_m.y / size_m, shift_m.z / size_m, turn_rad.x, turn_rad.y, turn_rad.z;
  return c;
}

constexpr double fine = 1e-15;           // of the scaled error: rounding
constexpr double least_damping = 1e-13;  // keeps a free joint where it is
constexpr double longest_step = 0.5;     // rad

// Newton's own step, without the square of J's condition, until one has failed.
Six step_of(const Square& j, const Six& error, double damping) {
  Six change;
  if (damping <= least_damping) change = linear::inverse(j) * error;
  if (damping > least_damping || !change.allFinite())
    change = optim::damped_step(Square(j.transpose() * j), Six(j.transpose() * error), damping).change;
  const double longest = change.cwiseAbs().maxCoeff();
  return longest > longest_step ? Six(change * (longest_step / longest)) : change;
}

}  // namespace

Refined measured(const Screws& screws, const Pose& wanted, const Joints& joints_rad) {
  const Miss miss = miss_of(flange_at(screws, joints_rad), wanted);
  return {joints_rad, norm(miss.position_m), norm(miss.rotation_rad)};
}

Refined refined(const Screws& screws, const Pose& wanted, const Joints& start_rad, int steps) {
  Joints at = start_rad;
  Motions motions = motions_at(screws, at);
  Miss miss = miss_of(motions.flange, wanted);
  Six error = column(miss.position_m, miss.rotation_rad, screws.size_m);
  double damping = least_damping;
  for (int step = 0; step < steps && error.norm() > fine && damping < 1e6; ++step) {
    Square j;
    for (int i = 0; i < 6; ++i) {
      const auto k = static_cast<std::size_t>(i);
      j.col(i) = column(motions.shift[k], motions.axis[k], screws.size_m);
    }
    const Six change = step_of(j, error, damping);
    Joints next = at;
    for (int i = 0; i < 6; ++i) next[static_cast<std::size_t>(i)] += change[i];
    const Motions there = motions_at(screws, next);
    const Miss left = miss_of(there.flange, wanted);
    const Six rest = column(left.position_m, left.rotation_rad, screws.size_m);
    if (!(rest.norm() < error.norm())) {
      if (error.norm() < 1e-13) break;  // rounding
      damping = std::max(damping * 10, 1e-6);
      continue;
    }
    const bool settled = rest.norm() > 0.999999 * error.norm() && damping <= 1e-6;
    at = next, motions = there, miss = left, error = rest;
    damping = std::max(damping / 10, least_damping);
    if (settled) break;
  }
  return {at, norm(miss.position_m), norm(miss.rotation_rad)};
}

}  // namespace gonio::robot::screws
