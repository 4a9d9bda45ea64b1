// Levenberg-Marquardt on trajectories in shape space by variable projection.
#include "nrsfm/solve/shape_trajectory.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/atomic_file.h"
#include "linear/qr.h"
#include "linear/solve.h"

namespace gonio::nrsfm {
namespace {

// What elimination leaves for one point.
struct Eliminated {
  Eigen::VectorXd s;         // 3K
  Eigen::VectorXd residual;  // 2F, 0 where missing
  double cost = 0;
  Eigen::MatrixXd q;                       // 2F x 3K
  std::vector<Eigen::MatrixXd> chain;      // complementary: I - chain_k in Q's coordinates is prod_(j >= k) (I - P_j)
  Eigen::MatrixXd gradient_left;           // 2F x K, gradient_right 3 x K: d cost / d c_fk / 2 =
  Eigen::MatrixXd gradient_right;          //   -(left_fk' D_f s_k + residual_fk' D_f right_k)
  std::vector<Eigen::VectorXd> residuals;  // complementary: after basis shape k
  std::vector<Eigen::MatrixXd> lever;      // complementary: 3K x 3, see one_by_one()
};

struct State {
  Eigen::MatrixXd x, coefficients;
  std::vector<Eliminated> points;
  double cost = 0;
};

Eigen::MatrixXd coefficients_of(const ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& x) {
  const Eigen::MatrixXd along = problem.omega * x;
  Eigen::MatrixXd coefficients;
  for (Eigen::Index f = 0; f < along.rows(); ++f) {
    const Eigen::VectorXd c = problem.coefficients(along.row(f).transpose());
    if (f == 0) coefficients.resize(along.rows(), c.size());
    coefficients.row(f) = c.transpose();
  }
  return coefficients;
}

// M, with the rows of missing tracks zero where `point` >= 0.
Eigen::MatrixXd motion_of(const ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& coefficients,
                          Eigen::Index point) {
  const Eigen::Index frames = coefficients.rows(), terms = coefficients.cols();
  Eigen::MatrixXd motion = Eigen::MatrixXd::Zero(2 * frames, 3 * terms);
  for (Eigen::Index f = 0; f < frames; ++f) {
    if (point >= 0 && !problem.visible(f, point)) continue;
    for (Eigen::Index k = 0; k < terms; ++k) {
      motion.block<2, 3>(2 * f, 3 * k) = coefficients(f, k) * problem.rows.middleRows<2>(2 * f);
    }
  }
  return motion;
}

// What |D_f|^2 c_fk^2 / 3 of a visible frame adds to the ridge of shape k of a point that `seen` of all frames see.
double ridge_weight(const ShapeTrajectoryProblem& problem, Eigen::Index k, Eigen::Index seen) {
  const double all_over_seen =
      static_cast<double>(problem.visible.rows()) / static_cast<double>(std::max<Eigen::Index>(seen, 1));
  return (k == 0 ? problem.mean_ridge : problem.ridge) * all_over_seen;
}

Eigen::Index seen_of(const ShapeTrajectoryProblem& problem, Eigen::Index point) {
  return point < 0 ? problem.visible.rows() : problem.visible.col(point).count();
}

Eigen::VectorXd ridges_of(const ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& motion, Eigen::Index point) {
  double natural = 0;
  for (Eigen::Index f = 0; f < problem.visible.rows() && problem.natural_size; ++f) {
    if (point < 0 || problem.visible(f, point)) natural += problem.rows.middleRows<2>(2 * f).squaredNorm();
  }
  Eigen::VectorXd ridges(motion.cols());
  for (Eigen::Index k = 0; k < motion.cols() / 3; ++k) {
    const double energy = problem.natural_size ? natural : motion.middleCols<3>(3 * k).squaredNorm();
    ridges.segment<3>(3 * k).setConstant(ridge_weight(problem, k, seen_of(problem, point)) * energy / 3 + 1e-300);
  }
  return ridges;
}

struct Factored {
  Eigen::MatrixXd motion, q;  // q: the upper part of the orthonormal factor of [M; ridge]
  linear::HouseholderQr qr;
  Eigen::VectorXd ridges;
};

Factored factored(const ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& coefficients, Eigen::Index point) {
  Factored result;
  result.motion = motion_of(problem, coefficients, point);
  result.ridges = ridges_of(problem, result.motion, point);
  const Eigen::Index rows = result.motion.rows(), columns = result.motion.cols();
  Eigen::MatrixXd stacked(rows + columns, columns);
  stacked.topRows(rows) = result.motion;
  stacked.bottomRows(columns) = result.ridges.cwiseSqrt().asDiagonal();
  result.qr = linear::HouseholderQr(stacked);
  result.q = result.qr.thin_q().topRows(rows);
  return result;
}

Eliminated together(const Factored& at, const Eigen::VectorXd& w) {
  Eliminated point;
  const Eigen::Index columns = at.motion.cols();
  const auto upper = at.qr.upper().triangularView<Eigen::Upper>();
  point.s = upper.solve(at.q.transpose() * w);
  point.residual = w - at.motion * point.s;
  point.cost = point.residual.squaredNorm() + point.s.cwiseAbs2().dot(at.ridges);
  point.gradient_left = point.residual.replicate(1, columns / 3);
  point.gradient_right = Eigen::MatrixXd::Zero(3, columns / 3);
  return point;
}

// r_k = r_(k-1) - M_k S_k and, of a change of M_k, with A_k = (I - P_K) .. (I - P_k),
//   d r_K = -A_k dM_k s_k - A_(k+1) (M_k^+)' dM_k' r_k
//         = -dM_k s_k + Q (chain_k Q' dM_k s_k - lever_k dM_k' r_k),   lever_k = Q' A_(k+1) (M_k^+)'
// so that with u_K = r_K, u_(k-1) = (I - P_k) u_k:  d cost / 2 = -u_(k-1)' dM_k s_k - (M_k^+ u_k)' dM_k' r_k.
Eliminated one_by_one(const Factored& at, const Eigen::VectorXd& w) {
  Eliminated point;
  const Eigen::Index columns = at.motion.cols(), terms = columns / 3;
  point.s.resize(columns);
  std::vector<Eigen::Matrix3d> inverse;
  Eigen::VectorXd r = w;
  for (Eigen::Index k = 0; k < terms; ++k) {
    const auto m = at.motion.middleCols<3>(3 * k);
    Eigen::Matrix3d normal = m.transpose() * m;
    normal.diagonal() += at.ridges.segment<3>(3 * k);
    inverse.push_back(normal.inverse());
    point.s.segment<3>(3 * k) = inverse.back() * (m.transpose() * r);
    r -= m * point.s.segment<3>(3 * k);
    point.residuals.push_back(r);
  }
  point.residual = r;
  point.cost = r.squaredNorm();
  point.gradient_left.resize(w.size(), terms);
  point.gradient_right.resize(3, terms);
  point.chain.resize(static_cast<std::size_t>(terms));
  point.lever.resize(static_cast<std::size_t>(terms));
  Eigen::VectorXd u = r;
  Eigen::MatrixXd product = Eigen::MatrixXd::Identity(columns, columns);
  for (Eigen::Index k = terms - 1; k >= 0; --k) {
    const auto m = at.motion.middleCols<3>(3 * k);
    const Eigen::Matrix3d& over = inverse[static_cast<std::size_t>(k)];
    const Eigen::Vector3d right = over * (m.transpose() * u);
    u -= m * right;
    point.gradient_left.col(k) = u;
    point.gradient_right.col(k) = right;
    const Eigen::MatrixXd inside = at.q.transpose() * m;
    point.lever[static_cast<std::size_t>(k)] = (product * inside).eval() * over;
    product -= (point.lever[static_cast<std::size_t>(k)] * inside.transpose()).eval();
    point.chain[static_cast<std::size_t>(k)] = Eigen::MatrixXd::Identity(columns, columns) - product;
  }
  return point;
}

State state_of(const ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& x) {
  State state;
  state.x = x;
  state.coefficients = coefficients_of(problem, x);
  const bool complete = problem.visible.all();
  Factored common;
  if (complete) common = factored(problem, state.coefficients, -1);
  for (Eigen::Index p = 0; p < problem.tracks.cols(); ++p) {
    if (!complete) common = factored(problem, state.coefficients, p);
    const Eigen::VectorXd w = problem.tracks.col(p);
    state.points.push_back(problem.complementary ? one_by_one(common, w) : together(common, w));
    state.points.back().q = complete && p > 0 ? Eigen::MatrixXd() : common.q;  // one for all where nothing is missing
    state.cost += state.points.back().cost;
  }
  return state;
}

struct Normal {
  Eigen::MatrixXd matrix;  // dq x dq, block (j, l) of d x d
  Eigen::VectorXd gradient;
};

// d cost / d C / 2 (F x K) into gradient_c, and B_f into `first` (K^2 x F, columns). The ridges' energies move with C:
// together they act as tracks at 0; one by one, r_k gains M_k (M_k'M_k + E_k)^-1 s_k dE_k.
void add_point(const ShapeTrajectoryProblem& problem, const State& state, Eigen::Index p, Eigen::MatrixXd& gradient_c,
               Eigen::MatrixXd& first) {
  const Eliminated& point = state.points[static_cast<std::size_t>(p)];
  const Eigen::Index terms = gradient_c.cols();
  const Eigen::Map<const Eigen::Matrix3Xd> s(point.s.data(), 3, terms);
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(terms);
  for (Eigen::Index k = 0; k < terms && !problem.natural_size; ++k) {
    const double along = problem.complementary ? 2 * point.gradient_right.col(k).dot(s.col(k)) : s.col(k).squaredNorm();
    pull(k) = ridge_weight(problem, k, seen_of(problem, p)) * along / 3;
  }
  for (Eigen::Index f = 0; f < gradient_c.rows(); ++f) {
    if (!problem.visible(f, p)) continue;
    const auto d = problem.rows.middleRows<2>(2 * f);
    const Eigen::Matrix2Xd seen = d * s;
    first.col(f) += (seen.transpose() * seen).reshaped();
    for (Eigen::Index k = 0; k < terms; ++k) {
      const double ridge = d.squaredNorm() * pull(k);
      gradient_c(f, k) += ridge * state.coefficients(f, k);
      if (!problem.complementary) first(k * (terms + 1), f) += ridge;
      gradient_c(f, k) -= point.gradient_left.col(k).segment<2>(2 * f).dot(seen.col(k));
      if (problem.complementary) {
        const auto& r = point.residuals[static_cast<std::size_t>(k)];
        gradient_c(f, k) -= r.segment<2>(2 * f).dot(d * point.gradient_right.col(k));
      }
    }
  }
}

// T_p: block j (columns j 3K ..) is d x 3K.
Eigen::MatrixXd projected_slopes(const ShapeTrajectoryProblem& problem, const Eliminated& point,
                                 const Eigen::MatrixXd& q, Eigen::Index p, const std::vector<Eigen::MatrixXd>& slopes) {
  const Eigen::Index frames = problem.omega.rows(), columns = q.cols(), unknowns = slopes.front().cols();
  const Eigen::Map<const Eigen::Matrix3Xd> s(point.s.data(), 3, columns / 3);
  Eigen::MatrixXd by_frame = Eigen::MatrixXd::Zero(columns * unknowns, frames);
  for (Eigen::Index f = 0; f < frames; ++f) {
    if (!problem.visible(f, p)) continue;
    const Eigen::Matrix2Xd seen = (problem.rows.middleRows<2>(2 * f) * s).eval() * slopes[static_cast<std::size_t>(f)];
    by_frame.col(f) = (q.middleRows<2>(2 * f).transpose() * seen).reshaped();
  }
  return problem.omega.transpose() * by_frame.transpose();
}

// What Q takes from the slopes of unknown j: U_j (3K x d) with J_j = -(E_j s - Q U_j). Together U_j = T_j'.
std::vector<Eigen::MatrixXd> taken_by_basis(const ShapeTrajectoryProblem& problem, const Eliminated& point,
                                            const std::vector<Eigen::MatrixXd>& t) {
  std::vector<Eigen::MatrixXd> taken;
  for (std::size_t j = 0; j < t.size(); ++j) {
    if (!problem.complementary) {
      taken.push_back(t[j].transpose());
      continue;
    }
    Eigen::Matrix3Xd back(3, problem.omega.rows());  // D_f' r_kf
    for (Eigen::Index f = 0; f < back.cols(); ++f) {
      back.col(f) = problem.rows.middleRows<2>(2 * f).transpose() * point.residuals[j].segment<2>(2 * f);
    }
    taken.push_back(point.chain[j] * t[j].transpose() - point.lever[j] * (back * problem.omega));
  }
  return taken;
}

// The blocks (j, l <= j) of the Gauss-Newton matrix but for their first sum.
void subtract_taken(const ShapeTrajectoryProblem& problem, const Eliminated& point, const Eigen::MatrixXd& slopes,
                    Eigen::MatrixXd& matrix) {
  const Eigen::Index d = problem.omega.cols(), unknowns = matrix.rows() / d, columns = slopes.cols() / unknowns;
  std::vector<Eigen::MatrixXd> t;
  for (Eigen::Index j = 0; j < unknowns; ++j) t.push_back(slopes.middleCols(j * columns, columns));
  const std::vector<Eigen::MatrixXd> taken = taken_by_basis(problem, point, t);
  for (Eigen::Index j = 0; j < unknowns; ++j) {
    const auto ju = static_cast<std::size_t>(j);
    for (Eigen::Index l = 0; l <= j; ++l) {
      const auto lu = static_cast<std::size_t>(l);
      auto block = matrix.block(j * d, l * d, d, d);
      block.noalias() -= t[ju] * taken[lu];
      if (!problem.complementary) continue;
      block.noalias() -= (t[lu] * taken[ju]).transpose();
      block.noalias() += taken[ju].transpose() * taken[lu];
    }
  }
}

Normal normal_of(const ShapeTrajectoryProblem& problem, const State& state) {
  const Eigen::Index frames = problem.omega.rows(), d = problem.omega.cols(), terms = state.coefficients.cols();
  const Eigen::Index q = state.x.cols();
  std::vector<Eigen::MatrixXd> slopes;
  const Eigen::MatrixXd along = problem.omega * state.x;
  for (Eigen::Index f = 0; f < frames; ++f) slopes.push_back(problem.slope(along.row(f).transpose()));
  Normal normal{Eigen::MatrixXd::Zero(d * q, d * q), Eigen::VectorXd::Zero(d * q)};
  Eigen::MatrixXd gradient_c = Eigen::MatrixXd::Zero(frames, terms);
  Eigen::MatrixXd first = Eigen::MatrixXd::Zero(terms * terms, frames);
  for (Eigen::Index p = 0; p < problem.tracks.cols(); ++p) {
    const Eliminated& point = state.points[static_cast<std::size_t>(p)];
    add_point(problem, state, p, gradient_c, first);
    const Eigen::MatrixXd& basis = point.q.size() > 0 ? point.q : state.points.front().q;
    subtract_taken(problem, point, projected_slopes(problem, point, basis, p, slopes), normal.matrix);
  }
  Eigen::MatrixXd inner(frames, q * q), gradient_x(frames, q);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const Eigen::MatrixXd& slope = slopes[static_cast<std::size_t>(f)];
    const Eigen::MatrixXd b = first.col(f).reshaped(terms, terms);
    inner.row(f) = ((slope.transpose() * b).eval() * slope).reshaped().transpose();
    gradient_x.row(f) = gradient_c.row(f) * slope;
  }
  for (Eigen::Index j = 0; j < q; ++j) {
    for (Eigen::Index l = 0; l <= j; ++l) {
      auto block = normal.matrix.block(j * d, l * d, d, d);
      block.noalias() += (problem.omega.transpose() * inner.col(l * q + j).asDiagonal()).eval() * problem.omega;
      if (l != j) normal.matrix.block(l * d, j * d, d, d) = block.transpose();
    }
    normal.gradient.segment(j * d, d) = problem.omega.transpose() * gradient_x.col(j);
  }
  return normal;
}

}  // namespace

ShapeTrajectory fit_shape_trajectory(const ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& start) {
  State state = state_of(problem, start);
  const Eigen::Index held = problem.held * problem.omega.cols(), free = start.size() - held;
  const double floor = 3e-15 * problem.tracks.squaredNorm();
  ShapeTrajectory fit;
  double damping = 1e-2;
  while (fit.iterations < problem.most_iterations && !fit.converged && free > 0) {
    throw_if_interrupted();
    const Normal normal = normal_of(problem, state);
    const double mean = normal.matrix.diagonal().tail(free).mean();
    bool better = false;
    for (int tries = 0; tries < 10 && !better; ++tries) {
      Eigen::MatrixXd damped = normal.matrix.bottomRightCorner(free, free);
      damped.diagonal().array() += damping * mean + 1e-300;
      Eigen::MatrixXd tried = state.x;
      tried.reshaped().tail(free) -= linear::solve_ldlt(damped, normal.gradient.tail(free));
      State next = state_of(problem, tried);
      better = next.cost < state.cost;
      if (!better) {
        damping *= 8;
        continue;
      }
      fit.converged = state.cost - next.cost <= problem.tolerance * state.cost || next.cost <= floor;
      state = std::move(next);
      damping = std::max(damping / 10, 1e-14);
    }
    ++fit.iterations;
    if (!better) fit.converged = true;
  }
  fit.x = state.x;
  fit.coefficients = state.coefficients;
  fit.cost = state.cost;
  fit.basis.resize(3 * state.coefficients.cols(), problem.tracks.cols());
  for (Eigen::Index p = 0; p < problem.tracks.cols(); ++p) {
    fit.basis.col(p) = state.points[static_cast<std::size_t>(p)].s;
  }
  return fit;
}

}  // namespace gonio::nrsfm
