// See refine.h. Newton's method as long as it leads down, then a damped descent; J scaled by the arm's size so that
// metres and radians count alike.
#include "robot/inverse/refine.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "optim/damped.h"
#include "optim/descent.h"

namespace gonio::robot::screws {
namespace {

using Six = Eigen::Matrix<double, 6, 1>;
using Square = Eigen::Matrix<double, 6, 6>;

Six column(Vec3 shift_m, Vec3 turn_rad, double size_m) {
  Six c;
  c << shift_m.x / size_m, shift_m.y / size_m, shift_m.z / size_m, turn_rad.x, turn_rad.y, turn_rad.z;
  return c;
}

constexpr double fine = 1e-15;        // of the scaled error: rounding
constexpr double good = 1e-13;        // below, a step that does not help is rounding's fault
constexpr double longest_step = 0.5;  // rad

Six no_longer(const Six& change) {
  const double longest = change.cwiseAbs().maxCoeff();
  return longest > longest_step ? Six(change * (longest_step / longest)) : change;
}

class FlangeDescent final : public optim::Descent {
 public:
  FlangeDescent(const Screws& screws, const Pose& wanted, const Joints& start_rad)
      : screws_(screws), wanted_(wanted), here_(at(start_rad)) {}

  double error() const { return here_.error.norm(); }
  Refined stand() const { return {here_.joints, norm(here_.miss.position_m), norm(here_.miss.rotation_rad)}; }

  // Newton's own step, without the square of J's condition; false where it does not lead down.
  bool newton_step() {
    const Six change = no_longer(linear::inverse(jacobian()) * here_.error);
    if (!change.allFinite()) return false;
    there_ = after(change);
    if (!(there_.error.norm() < error())) return false;
    accept();
    return true;
  }

  void linearise() override {
    const Square j = jacobian();
    h_ = j.transpose() * j, downhill_ = j.transpose() * here_.error;
  }
  optim::Proposal propose(double damping) override {
    const Six change = no_longer(optim::damped_step(h_, downhill_, damping).change);
    there_ = after(change);
    return {optim::promised_fall(h_, downhill_, change), change.norm()};
  }
  double evaluate() override { return there_.error.squaredNorm(); }
  void accept() override { here_ = there_; }

 private:
  struct Place {
    Joints joints;
    Motions motions;
    Miss miss;
    Six error;
  };
  Place at(const Joints& joints) const {
    Place p{joints, motions_at(screws_, joints), {}, {}};
    p.miss = miss_of(p.motions.flange, wanted_);
    p.error = column(p.miss.position_m, p.miss.rotation_rad, screws_.size_m);
    return p;
  }
  Place after(const Six& change) const {
    Joints joints = here_.joints;
    for (int i = 0; i < 6; ++i) joints[static_cast<std::size_t>(i)] += change[i];
    return at(joints);
  }
  Square jacobian() const {
    Square j;
    for (int i = 0; i < 6; ++i) {
      const auto k = static_cast<std::size_t>(i);
      j.col(i) = column(here_.motions.shift[k], here_.motions.axis[k], screws_.size_m);
    }
    return j;
  }

  const Screws& screws_;
  const Pose& wanted_;
  Place here_, there_;
  Square h_;
  Six downhill_;
};

}  // namespace

Refined measured(const Screws& screws, const Pose& wanted, const Joints& joints_rad) {
  const Miss miss = miss_of(flange_at(screws, joints_rad), wanted);
  return {joints_rad, norm(miss.position_m), norm(miss.rotation_rad)};
}

Refined refined(const Screws& screws, const Pose& wanted, const Joints& start_rad, int steps) {
  FlangeDescent descent(screws, wanted, start_rad);
  int step = 0;
  while (step < steps && descent.error() > fine && descent.newton_step()) ++step;
  if (step >= steps || descent.error() < good) return descent.stand();
  optim::Limits limits;
  limits.most_steps = steps - step;
  limits.first_damping = 1e-6, limits.least_damping = 1e-13;
  limits.floor = fine * fine;
  limits.small_fall = {1e-6, 0};
  optim::descend(descent, descent.error() * descent.error(), limits);
  return descent.stand();
}

}  // namespace gonio::robot::screws
