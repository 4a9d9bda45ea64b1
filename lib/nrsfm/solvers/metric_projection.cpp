// Metric projections: a low-rank model whose motion stays one of rotations at every step, from incomplete tracks.
//   min sum over visible (f, p) of |w_fp - R_f sum_k c_fk B_kp - t_f|^2
// In turns (Paladini, Del Bue, Stosic, Dodig, Xavier & Agapito, CVPR 2009; IJCV 96 (2012)): the basis B by least
// squares for each point; each frame's unconstrained motion M_f = W_f B^+ over its visible points, projected onto the
// manifold [c_1 R .. c_K R] (motion_manifold.h). The projection is nearest in the motion's entries, not in the image:
// from it, and from the frame's last camera, weights and rotation go on to less reprojection error, and the better one
// stays. Weak-perspective scales are part of c. Neither step of the paper bounds what few tracks leave open; here
// weights after the first and basis shapes have normal priors of their own sizes,
//   + sigma^2 (sum_(k > 1) c_fk^2 + sum_k |B_k|^2 / b_k^2),   c of unit covariance, b_k^2 the mean square of B_k,
// sigma^2 the residuals' variance over what is left free: shapes that noise alone supports die out, and exact tracks
// come back exactly. Two starts, both with the cameras of csf: the mean and the first K - 1 modes of the shapes of
// least nuclear norm (low_rank.h), and of csf's shapes; the one with less error after a few turns goes on.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "linear/qr.h"
#include "linear/solve.h"
#include "linear/svd.h"
#include "nrsfm/solve/low_rank.h"
#include "nrsfm/solve/motion_manifold.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

constexpr int kTurnsOfEachStart = 10;

struct State {
  std::vector<CameraRows> rotations;
  Eigen::MatrixXd weights;  // F x K
  Eigen::MatrixXd basis;    // 3K x P
  Eigen::VectorXd translation;
  double variance = 0;         // sigma^2
  Eigen::Index certified = 0;  // frames, of the last turn
};

Eigen::MatrixXd motion_of(const State& state) {
  const Eigen::Index frames = state.weights.rows(), terms = state.weights.cols();
  Eigen::MatrixXd motion(2 * frames, 3 * terms);
  for (Eigen::Index f = 0; f < frames; ++f) {
    for (Eigen::Index k = 0; k < terms; ++k) {
      motion.block<2, 3>(2 * f, 3 * k) = state.weights(f, k) * state.rotations[static_cast<std::size_t>(f)];
    }
  }
  return motion;
}

// Weights of unit covariance, the first as it was but for its size: products c B stay what they are.
void balance(State& state) {
  const Eigen::Index frames = state.weights.rows(), terms = state.weights.cols(), points = state.basis.cols();
  const linear::HouseholderQr qr(state.weights);
  const double root = std::sqrt(static_cast<double>(frames));
  const Eigen::MatrixXd upper = qr.upper() / root;
  state.weights = qr.thin_q() * root;
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(3 * terms, points);
  for (Eigen::Index k = 0; k < terms; ++k) {
    for (Eigen::Index l = k; l < terms; ++l) {
      basis.middleRows<3>(3 * k) += upper(k, l) * state.basis.middleRows<3>(3 * l);
    }
  }
  state.basis = std::move(basis);
}

void solve_basis(const Sequence& sequence, State& state) {
  const Eigen::MatrixXd motion = motion_of(state);
  const Eigen::Index columns = motion.cols();
  const double points = static_cast<double>(sequence.points()), least = 1e-12 * motion.squaredNorm();
  Eigen::VectorXd ridges(columns);
  for (Eigen::Index k = 0; k < columns / 3; ++k) {
    const double square = state.basis.middleRows<3>(3 * k).squaredNorm() / (3 * points);
    ridges.segment<3>(3 * k).setConstant(std::max(state.variance / std::max(square, 1e-300), least));
  }
  for (Eigen::Index p = 0; p < sequence.points(); ++p) {
    Eigen::MatrixXd normal = ridges.asDiagonal();
    Eigen::VectorXd right = Eigen::VectorXd::Zero(columns);
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      if (!sequence.visible(f, p)) continue;
      const auto rows = motion.middleRows<2>(2 * f);
      normal.noalias() += rows.transpose() * rows;
      right.noalias() +=
          rows.transpose() * (sequence.tracks.block<2, 1>(2 * f, p) - state.translation.segment<2>(2 * f));
    }
    state.basis.col(p) = linear::solve_ldlt(normal, right);
  }
}

// What one frame sees, less the means over its visible points.
struct FrameView {
  Eigen::Matrix2Xd tracks;
  Eigen::MatrixXd basis;
  Eigen::Vector2d track_mean;
  Eigen::VectorXd basis_mean;
};

FrameView view_of(const Sequence& sequence, const State& state, Eigen::Index f) {
  FrameView view;
  const Eigen::Index count = sequence.visible.row(f).count();
  view.tracks.resize(2, count);
  view.basis.resize(state.basis.rows(), count);
  for (Eigen::Index p = 0, at = 0; p < sequence.points(); ++p) {
    if (!sequence.visible(f, p)) continue;
    view.tracks.col(at) = sequence.tracks.block<2, 1>(2 * f, p);
    view.basis.col(at++) = state.basis.col(p);
  }
  view.track_mean = view.tracks.rowwise().mean();
  view.basis_mean = view.basis.rowwise().mean();
  view.tracks.colwise() -= view.track_mean;
  view.basis.colwise() -= view.basis_mean;
  return view;
}

struct FrameMotion {
  CameraRows rotation;
  Eigen::VectorXd weights;
  double residual = 0, cost = 0;  // cost: with the prior of the weights
};

Eigen::Matrix3Xd shape_from(const Eigen::MatrixXd& basis, const Eigen::VectorXd& weights) {
  Eigen::Matrix3Xd shape = Eigen::Matrix3Xd::Zero(3, basis.cols());
  for (Eigen::Index k = 0; k < weights.size(); ++k) shape += weights(k) * basis.middleRows<3>(3 * k);
  return shape;
}

void solve_weights(const FrameView& view, double variance, FrameMotion& motion) {
  const Eigen::Index terms = motion.weights.size();
  Eigen::MatrixXd seen(2 * view.tracks.cols(), terms);
  for (Eigen::Index k = 0; k < terms; ++k) {
    seen.col(k) = (motion.rotation * view.basis.middleRows<3>(3 * k)).reshaped();
  }
  Eigen::MatrixXd normal = seen.transpose() * seen;
  normal.diagonal().array() += 1e-12 * normal.trace() / static_cast<double>(terms);
  normal.diagonal().tail(terms - 1).array() += variance;
  motion.weights = linear::solve_ldlt(normal, seen.transpose() * view.tracks.reshaped());
  motion.residual = (view.tracks.reshaped() - seen * motion.weights).squaredNorm();
  motion.cost = motion.residual + variance * motion.weights.tail(terms - 1).squaredNorm();
}

// Weights, then a Gauss-Newton rotation given the weights, and the weights again.
FrameMotion polished(const FrameView& view, double variance, FrameMotion motion) {
  solve_weights(view, variance, motion);
  const Eigen::Array<bool, 1, Eigen::Dynamic> all =
      Eigen::Array<bool, 1, Eigen::Dynamic>::Constant(view.tracks.cols(), true);
  WeakCamera camera;
  camera.rotation = motion.rotation;
  motion.rotation = fit_camera(view.tracks, all, shape_from(view.basis, motion.weights), camera, false).rotation;
  solve_weights(view, variance, motion);
  return motion;
}

// The sum of squared residuals.
double solve_frames(const Sequence& sequence, State& state) {
  double sum = 0;
  state.certified = 0;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    const FrameView view = view_of(sequence, state, f);
    CameraRows& rotation = state.rotations[static_cast<std::size_t>(f)];
    Eigen::MatrixXd normal = view.basis * view.basis.transpose();
    normal.diagonal().array() += state.variance + 1e-12 * normal.trace();
    const Eigen::MatrixXd free = linear::solve_ldlt(normal, view.basis * view.tracks.transpose()).transpose();
    const OnManifold projected = nearest_motion(free, rotation);
    state.certified += projected.certified ? 1 : 0;
    FrameMotion best = polished(view, state.variance, {rotation, state.weights.row(f).transpose()});
    const FrameMotion other = polished(view, state.variance, {projected.rotation, projected.weights});
    if (other.cost < best.cost) best = other;
    rotation = best.rotation;
    state.weights.row(f) = best.weights.transpose();
    state.translation.segment<2>(2 * f) = view.track_mean - rotation * shape_from(view.basis_mean, best.weights);
    sum += best.residual;
  }
  return sum;
}

// Of residuals with this sum, over what 3K numbers per point and K + 5 per frame leave free.
double variance_of(const Sequence& sequence, Eigen::Index terms, double sum) {
  const double seen = 2 * static_cast<double>(sequence.visible.count());
  const double taken = static_cast<double>(3 * terms * sequence.points() + (terms + 5) * sequence.frames());
  return sum / std::max(seen - taken, 0.1 * seen);
}

// The mean shape and the largest modes of shapes (3F x P).
State state_from(const Sequence& sequence, const Start& start, const Shapes& shapes, Eigen::Index terms) {
  State state;
  state.rotations = start.upgrade.rotations;
  state.translation = start.translation;
  const Eigen::Index frames = sequence.frames();
  Eigen::MatrixXd less = rearranged(shapes);
  const Eigen::RowVectorXd mean = less.colwise().mean();
  less.rowwise() -= mean;
  const linear::DividedSvd svd(less, Eigen::ComputeThinU | Eigen::ComputeThinV);
  state.weights = Eigen::MatrixXd::Ones(frames, terms);
  state.basis.resize(3 * terms, sequence.points());
  state.basis.topRows<3>() = arranged(mean);
  const double root = std::sqrt(static_cast<double>(frames));
  for (Eigen::Index k = 1; k < terms; ++k) {
    state.weights.col(k) = root * svd.matrixU().col(k - 1);
    state.basis.middleRows<3>(3 * k) =
        svd.singularValues()(k - 1) / root * arranged(svd.matrixV().col(k - 1).transpose());
  }
  double sum = 0;
  for (Eigen::Index f = 0; f < frames; ++f) {
    state.weights.row(f) *= start.upgrade.scales(f);
    const Eigen::Matrix2Xd seen =
        state.rotations[static_cast<std::size_t>(f)] * shape_from(state.basis, state.weights.row(f).transpose());
    sum += (start.w.middleRows<2>(2 * f) - seen).squaredNorm();
  }
  state.variance = variance_of(sequence, terms, sum);
  return state;
}

State from_low_rank(const Sequence& sequence, const Start& start, Eigen::Index terms) {
  return state_from(sequence, start, low_rank_shapes({start.w, start.rows, {}, 0}, {1e-3, 200}).shapes, terms);
}

State from_smooth_curves(const Sequence& sequence, Start start, Eigen::Index terms) {
  const Eigen::Index d = std::min(sequence.frames(), std::max((sequence.frames() + 5) / 10, 2 * terms));
  ShapeTrajectoryProblem problem = linear_problem(sequence, start, d);
  problem.most_iterations = 20;
  const ShapeTrajectory fit = fit_with_translation(problem, Eigen::MatrixXd::Identity(d, terms), start.translation);
  return state_from(sequence, start, shapes_of(fit.coefficients, fit.basis), terms);
}

// Turns until the sum of squares settles; its value.
struct Turns {
  double sum = 0;
  int count = 0;
  bool converged = false;
};

void take_turns(const Sequence& sequence, int most, State& state, Turns& turns) {
  const double floor = 1e-24 * centred(sequence).w.squaredNorm();
  while (!turns.converged && turns.count < most) {
    throw_if_interrupted();
    balance(state);
    solve_basis(sequence, state);
    const double before = turns.sum;
    turns.sum = solve_frames(sequence, state);
    state.variance = variance_of(sequence, state.weights.cols(), turns.sum);
    turns.converged = turns.sum <= floor || (turns.count > 0 && std::abs(before - turns.sum) <= 1e-4 * before);
    ++turns.count;
  }
}

class MetricProjection : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "metric_projection",
        "metric projections",
        "K basis shapes; each frame's motion is projected onto rotations times weights; least reprojection error.",
        "Paladini, Del Bue, Stosic, Dodig, Xavier & Agapito, CVPR 2009 and IJCV 96 (2012)",
        Prior::shape_basis,
        true,
        true,
        false,
        {rank_parameter("shapes of the basis with the mean, K"), camera_rank_parameter(), free_scales_parameter()}};
    return info;
  }

  Solution solve(const Sequence& sequence, const SolverOptions& options) const override {
    const Eigen::Index rank = std::min(shapes_of_model(info(), sequence, options), sequence.frames() - 1);
    Solution solution;
    const Start start = start_for(info(), sequence, options, rank, solution);
    const int most = options.most_iterations > 0 ? options.most_iterations : 150;
    State state = from_low_rank(sequence, start, rank), other = from_smooth_curves(sequence, start, rank);
    Turns turns, other_turns;
    take_turns(sequence, std::min(kTurnsOfEachStart, most), state, turns);
    take_turns(sequence, std::min(kTurnsOfEachStart, most), other, other_turns);
    if (other_turns.sum < turns.sum) {
      state = std::move(other);
      turns = other_turns;
    }
    take_turns(sequence, most, state, turns);
    solution.iterations = turns.count;
    solution.converged = turns.converged;
    solution.notes.push_back("the last projection is proven the nearest for " + std::to_string(state.certified) +
                             " of " + std::to_string(sequence.frames()) + " frames");
    const Eigen::VectorXd middle = state.basis.rowwise().mean();
    solution.reconstruction.shapes = shapes_of(state.weights, state.basis.colwise() - middle);
    solution.reconstruction.rotations = state.rotations;
    turn_to_first_camera(solution.reconstruction);
    solution.values["rank"] = static_cast<double>(rank);
    return solution;
  }
};

}  // namespace

const Solver& metric_projection() {
  static const MetricProjection solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
