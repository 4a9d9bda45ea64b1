// The barrier's Newton steps, by the Schur complement of the distances.
//   h = d^2 - a z_i^2 + 2 b z_i z_j - c z_j^2,   a = q_i.q_i, b = q_i.q_j, c = q_j.q_j,   barrier -log h:
//   gradient -h'/h,  Hessian h'h'' / h^2 - h_2 / h  with h' the gradient and h_2 the Hessian of h
// With H_f the Hessian of frame f's depths, B_f (P x E) that of depths against distances, D the distances' diagonal:
//   (D - sum B_f' H_f^-1 B_f) dd + nu 1 = -g_d + sum B_f' H_f^-1 g_f,   1'dd = 0,   dz_f = -H_f^-1 (g_f + B_f dd)
#include "nrsfm/solve/inextensible.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/atomic_file.h"
#include "linear/solve.h"

namespace gonio::nrsfm {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

struct Cone {
  Eigen::Index edge = 0, i = 0, j = 0;
  double a = 0, b = 0, c = 0;
  double quadratic(double zi, double zj) const { return a * zi * zi - 2 * b * zi * zj + c * zj * zj; }
};

struct Cones {
  std::vector<std::vector<Cone>> frames;
  Visible held;  // depths that an edge holds
  Eigen::Index edges = 0;
  double count = 0;   // of cones
  double depths = 0;  // held
};

Cones cones_of(const InextensibleProblem& problem) {
  Cones cones;
  cones.edges = static_cast<Eigen::Index>(problem.edges.size());
  cones.held = Visible::Constant(problem.visible.rows(), problem.visible.cols(), false);
  for (Eigen::Index f = 0; f < problem.visible.rows(); ++f) {
    const Eigen::Matrix3Xd& q = problem.sight[static_cast<std::size_t>(f)];
    std::vector<Cone>& frame = cones.frames.emplace_back();
    for (Eigen::Index e = 0; e < cones.edges; ++e) {
      const auto [i, j] = problem.edges[static_cast<std::size_t>(e)];
      if (!problem.visible(f, i) || !problem.visible(f, j)) continue;
      frame.push_back({e, i, j, q.col(i).squaredNorm(), q.col(i).dot(q.col(j)), q.col(j).squaredNorm()});
      cones.held(f, i) = cones.held(f, j) = true;
    }
    cones.count += static_cast<double>(frame.size());
  }
  cones.depths = static_cast<double>(cones.held.count());
  return cones;
}

struct Point {
  Eigen::MatrixXd z;  // F x P; 1 where not held
  Eigen::VectorXd d;
};

// Infinite outside.
double barrier(const Cones& cones, const Point& at, double t) {
  double value = 0;
  for (Eigen::Index f = 0; f < at.z.rows(); ++f) {
    for (Eigen::Index p = 0; p < at.z.cols(); ++p) {
      if (!cones.held(f, p)) continue;
      if (!(at.z(f, p) > 0)) return std::numeric_limits<double>::infinity();
      value -= t * at.z(f, p) + std::log(at.z(f, p));
    }
    for (const Cone& cone : cones.frames[static_cast<std::size_t>(f)]) {
      const double d = at.d(cone.edge), h = d * d - cone.quadratic(at.z(f, cone.i), at.z(f, cone.j));
      if (!(d > 0 && h > 0)) return std::numeric_limits<double>::infinity();
      value -= std::log(h);
    }
  }
  return value;
}

struct FrameTerms {
  linear::Llt factor;  // of H_f
  Eigen::VectorXd gradient;
  Sparse mixed;  // B_f
};

struct Step {
  Point direction;
  double decrement = 0;  // squared
  bool sound = true;
};

FrameTerms frame_terms(const Cones& cones, const Point& at, double t, Eigen::Index f, Eigen::VectorXd& gradient_d,
                       Eigen::VectorXd& hessian_d) {
  const Eigen::Index points = at.z.cols();
  FrameTerms terms;
  terms.gradient = Eigen::VectorXd::Zero(points);
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(points, points);
  for (Eigen::Index p = 0; p < points; ++p) {
    const double z = at.z(f, p);
    hessian(p, p) = cones.held(f, p) ? 1 / (z * z) : 1;
    terms.gradient(p) = cones.held(f, p) ? -t - 1 / z : 0;
  }
  std::vector<Eigen::Triplet<double>> mixed;
  for (const Cone& cone : cones.frames[static_cast<std::size_t>(f)]) {
    const double zi = at.z(f, cone.i), zj = at.z(f, cone.j), d = at.d(cone.edge);
    const double h = d * d - cone.quadratic(zi, zj);
    const double hi = 2 * (cone.b * zj - cone.a * zi) / h, hj = 2 * (cone.b * zi - cone.c * zj) / h, hd = 2 * d / h;
    terms.gradient(cone.i) -= hi;
    terms.gradient(cone.j) -= hj;
    gradient_d(cone.edge) -= hd;
    hessian(cone.i, cone.i) += hi * hi + 2 * cone.a / h;
    hessian(cone.j, cone.j) += hj * hj + 2 * cone.c / h;
    hessian(cone.i, cone.j) += hi * hj - 2 * cone.b / h;
    hessian(cone.j, cone.i) += hi * hj - 2 * cone.b / h;
    hessian_d(cone.edge) += hd * hd - 2 / h;
    mixed.emplace_back(cone.i, cone.edge, hi * hd);
    mixed.emplace_back(cone.j, cone.edge, hj * hd);
  }
  terms.mixed.resize(points, cones.edges);
  terms.mixed.setFromTriplets(mixed.begin(), mixed.end());
  terms.factor = linear::Llt(hessian);
  return terms;
}

Step newton(const Cones& cones, const Point& at, double t) {
  const Eigen::Index frames = at.z.rows(), points = at.z.cols();
  Eigen::VectorXd gradient_d = Eigen::VectorXd::Zero(cones.edges), hessian_d = gradient_d;
  std::vector<FrameTerms> terms;
  for (Eigen::Index f = 0; f < frames; ++f) terms.push_back(frame_terms(cones, at, t, f, gradient_d, hessian_d));
  Eigen::MatrixXd schur = hessian_d.asDiagonal();
  Eigen::VectorXd right = -gradient_d;
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(points, points);
  Step step;
  for (const FrameTerms& frame : terms) {
    step.sound = step.sound && frame.factor.info() == Eigen::Success;
    const Eigen::MatrixXd solved = frame.factor.solve(unit) * frame.mixed;
    schur.noalias() -= frame.mixed.transpose() * solved;
    right += solved.transpose() * frame.gradient;
  }
  const linear::Llt factor(schur);
  step.sound = step.sound && factor.info() == Eigen::Success;
  if (!step.sound) return step;
  const Eigen::VectorXd along = factor.solve(right), even = factor.solve(Eigen::VectorXd::Ones(cones.edges));
  step.direction.d = along - along.sum() / even.sum() * even;
  step.direction.z.resize(frames, points);
  step.decrement = -gradient_d.dot(step.direction.d);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const FrameTerms& frame = terms[static_cast<std::size_t>(f)];
    const Eigen::VectorXd dz = -frame.factor.solve(frame.gradient + frame.mixed * step.direction.d);
    step.direction.z.row(f) = dz.transpose();
    step.decrement -= frame.gradient.dot(dz);
  }
  return step;
}

// Along the direction while the barrier falls by a tenth of what its slope says; false where rounding ends that.
bool advance(const Cones& cones, Point& at, const Step& step, double t) {
  const double here = barrier(cones, at, t);
  for (double length = 1; length > 1e-9; length /= 2) {
    Point next{at.z + length * step.direction.z, at.d + length * step.direction.d};
    if (!(barrier(cones, next, t) < here - 0.1 * length * step.decrement)) continue;
    at = std::move(next);
    return true;
  }
  return false;
}

// All depths equal, distances a little longer than they have to be.
Point start_of(const Cones& cones, const InextensibleProblem& problem) {
  Point at{Eigen::MatrixXd::Ones(problem.visible.rows(), problem.visible.cols()), Eigen::VectorXd::Zero(cones.edges)};
  for (const std::vector<Cone>& frame : cones.frames) {
    for (const Cone& cone : frame) {
      at.d(cone.edge) = std::max(at.d(cone.edge), std::sqrt(std::max(0.0, cone.quadratic(1, 1))));
    }
  }
  at.d.array() += 0.1 * std::max(at.d.mean(), 1e-12);
  const double scale = static_cast<double>(cones.edges) / at.d.sum();
  at.d *= scale;
  at.z = cones.held.select(scale * at.z, 1.0);
  return at;
}

}  // namespace

InextensibleDepths deepest(const InextensibleProblem& problem, const InextensibleOptions& options) {
  const Cones cones = cones_of(problem);
  Point at = start_of(cones, problem);
  const auto sum_of = [&] { return cones.held.select(at.z.array(), 0.0).sum(); };
  const double barriers = 2 * cones.count + cones.depths;
  InextensibleDepths result;
  double t = barriers / sum_of();
  while (result.iterations < options.most_iterations) {
    throw_if_interrupted();
    const Step step = newton(cones, at, t);
    if (!step.sound) break;
    ++result.iterations;
    const bool centred = step.decrement < 1e-6 || !advance(cones, at, step, t);
    result.gap = barriers / t;
    if (!centred && step.decrement > 1e-2) continue;
    result.converged = result.gap <= options.gap * sum_of();
    if (result.converged) break;
    t *= 20;
  }
  result.sum = sum_of();
  result.distances = at.d;
  result.depths = cones.held.select(at.z, std::numeric_limits<double>::quiet_NaN());
  return result;
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> neighbour_edges(const std::vector<Eigen::Matrix3Xd>& sight,
                                                                   const Visible& visible, Eigen::Index neighbours) {
  const Eigen::Index points = visible.cols();
  std::set<std::pair<Eigen::Index, Eigen::Index>> edges;
  for (Eigen::Index i = 0; i < points; ++i) {
    std::vector<std::pair<double, Eigen::Index>> others;
    for (Eigen::Index j = 0; j < points; ++j) {
      const auto both = visible.col(i) && visible.col(j);
      const Eigen::Index together = both.count();
      if (j == i || together == 0 || 2 * together < std::min(visible.col(i).count(), visible.col(j).count())) continue;
      double largest = 0;
      for (Eigen::Index f = 0; f < visible.rows(); ++f) {
        const Eigen::Matrix3Xd& q = sight[static_cast<std::size_t>(f)];
        if (both(f)) largest = std::max(largest, (q.col(i) - q.col(j)).squaredNorm());
      }
      others.emplace_back(largest, j);
    }
    const auto many = std::min<std::ptrdiff_t>(neighbours, std::ssize(others));
    std::partial_sort(others.begin(), others.begin() + many, others.end());
    for (std::ptrdiff_t n = 0; n < many; ++n) {
      edges.insert(std::minmax(i, Eigen::Index(others[static_cast<std::size_t>(n)].second)));
    }
  }
  return {edges.begin(), edges.end()};
}

}  // namespace gonio::nrsfm
