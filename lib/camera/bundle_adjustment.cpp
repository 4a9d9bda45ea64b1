// The descent: damped normal equations with the placements eliminated, under the shared control (optim/descent.h).
#include "camera/bundle_adjustment.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "optim/descent.h"

namespace gonio::camera {
namespace {

using Kind = SharedParameter::Kind;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Change6 = Eigen::Matrix<double, 6, 1>;

constexpr int most_iterations = 100;
constexpr double settled = 1e-9;   // promised descent over the variance: a step of 3e-5 standard deviations
constexpr double hardly = 1e-4;    // the same where rounding leaves no descent
constexpr double exact_px = 1e-9;  // residuals that are rounding

struct Step {
  Vector shared;
  std::vector<Change6> placements;
  double promised = 0;  // descent of the cost by the quadratic model
  bool solved = false;
};

Step damped_step(const NormalEquations& n, double damping) {
  const Eigen::Index k = n.a.rows();
  Matrix s = n.a;
  s.diagonal() *= 1 + damping;
  Vector g = n.g;
  std::vector<Matrix> reduced(n.c.size());  // C^-1 B'
  std::vector<Change6> own(n.c.size(), Change6::Zero());
  for (std::size_t p = 0; p < n.c.size(); ++p) {
    if (!(n.c[p](0, 0) > 0)) continue;
    Eigen::Matrix<double, 6, 6> c = n.c[p];
    c.diagonal() *= 1 + damping;
    const linear::Ldlt solver(c);
    own[p] = solver.solve(n.h[p]);
    reduced[p] = solver.solve(n.b[p].transpose());
    s.noalias() -= n.b[p] * reduced[p];
    g.noalias() -= n.b[p] * own[p];
  }
  Step step{Vector::Zero(k), std::move(own), 0, true};
  if (k > 0) {
    const Vector scale = n.a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Matrix scaled = scale.asDiagonal() * s * scale.asDiagonal();
    step.shared = scale.asDiagonal() * linear::solve_ldlt(scaled, scale.asDiagonal() * g);
  }
  const auto gain = [damping](const auto& d, const auto& gradient, const auto& diagonal) {
    return d.dot(gradient) + damping * d.dot(diagonal.cwiseProduct(d));
  };
  step.promised = k > 0 ? gain(step.shared, n.g, Vector(n.a.diagonal())) : 0;
  for (std::size_t p = 0; p < n.c.size(); ++p) {
    if (!(n.c[p](0, 0) > 0)) continue;
    if (k > 0) step.placements[p] -= reduced[p] * step.shared;
    step.promised += gain(step.placements[p], n.h[p], Change6(n.c[p].diagonal()));
    step.solved = step.solved && step.placements[p].allFinite();
  }
  step.solved = step.solved && step.shared.allFinite();
  return step;
}

std::array<double, 6> array_of(const Change6& change) {
  return {change(0), change(1), change(2), change(3), change(4), change(5)};
}

template <class To, class From>
Rigid<To, From> turned(const Rigid<To, From>& pose, const std::array<double, 6>& change) {
  const BoardPose result = moved({pose.rotation, pose.translation_m}, change);
  return {result.rotation, result.translation_m};
}

Adjustment stepped(const Adjustment& state, const std::vector<FreeParameter>& free, const Step& step) {
  Adjustment next = state;
  std::vector<std::array<double, 6>> rig(state.lenses.size());
  for (std::size_t p = 0; p < free.size(); ++p) {
    const double d = step.shared(static_cast<Eigen::Index>(p));
    const auto& [what, columns] = free[p];
    for (const auto& [column, factor] : columns) {
      if (what.kind == Kind::rig) {
        rig[what.of][column] += factor * d;
      } else if (what.kind == Kind::board) {
        BoardWarp& warp = next.warps[what.of];
        (column == BoardColumn::warp ? warp.sag_x_m : warp.sag_y_m) += factor * d;
      } else {
        Intrinsics& lens = next.lenses[what.of];
        const std::array<double*, 4> pinhole{&lens.fx_px, &lens.fy_px, &lens.cx_px, &lens.cy_px};
        (column < 4 ? *pinhole[column] : lens.distortion[column - BoardColumn::distortion]) += factor * d;
      }
    }
  }
  for (std::size_t c = 0; c < rig.size(); ++c) {
    if (state.tied[c]) next.camera_from_rig[c] = turned(state.camera_from_rig[c], rig[c]);
  }
  for (std::size_t p = 0; p < state.placements.size(); ++p) {
    next.placements[p] = turned(state.placements[p], array_of(step.placements[p]));
  }
  return next;
}

bool sensible(const Adjustment& state) {
  return std::ranges::all_of(state.lenses, [](const Intrinsics& lens) { return lens.fx_px > 1 && lens.fy_px > 1; });
}

struct Bundle final : optim::Descent {
  const std::vector<View>& views;
  const CalibrationSetup& setup;
  const std::vector<FreeParameter> free;
  Adjustment& state;
  Adjustment next;
  NormalEquations at, there;
  Step step;

  Bundle(const std::vector<View>& of, const CalibrationSetup& s, Adjustment& start)
      : views(of), setup(s), free(free_parameters(s, start)), state(start), at(normal_equations(of, s, free, start)) {}
  void linearise() override {}  // evaluate() has
  optim::Proposal propose(double damping) override {
    step = damped_step(at, damping);
    return {step.solved ? step.promised : NAN};
  }
  double evaluate() override {
    if (!step.solved) return HUGE_VAL;
    next = stepped(state, free, step);
    if (!sensible(next)) return HUGE_VAL;
    there = normal_equations(views, setup, free, next);
    return there.cost;
  }
  void accept() override {
    std::swap(state, next);
    std::swap(at, there);
  }
};

}  // namespace

void adjust(const std::vector<View>& views, const CalibrationSetup& setup, Adjustment& state) {
  Bundle bundle(views, setup, state);
  const double coordinates = std::max(1.0, bundle.at.coordinates);
  optim::Limits limits;
  limits.most_trials = most_iterations;
  limits.first_damping = 1e-4;
  limits.least_damping = 1e-15;
  limits.floor = exact_px * exact_px * coordinates;
  limits.small_fall = {};
  limits.small_promise = {settled / coordinates, 0};
  limits.rounding = {hardly / coordinates, 0};
  const bool converged = optim::descend(bundle, bundle.at.cost, limits).settled();
  state.converged = converged;
}

}  // namespace gonio::camera
