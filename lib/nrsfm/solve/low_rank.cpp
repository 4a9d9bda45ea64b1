// Alternating directions for shapes of least nuclear norm.
//   S <- argmin coupling/2 |D S|^2 + rho/2 |S - Z + U|^2 over the depths y,   Z <- threshold(S + U, 1 / rho),
//   U <- U + S - Z
// With S_a = A_a + diag(n_a) y for the axes a, A = M^+ W and A orthogonal to n, the normal equations of y are
//   (rho I + coupling sum_a diag(n_a) L diag(n_a)) y = sum_a diag(n_a) (rho (Z - U)_a - coupling L A_a),
// one F x F factorization for all points. rho follows the two residuals (Boyd et al. 2011, equation 3.13).
#include "nrsfm/solve/low_rank.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "base/atomic_file.h"
#include "linear/solve.h"
#include "linear/svd.h"
#include "linear/symmetric_eigen.h"

namespace gonio::nrsfm {
namespace {

struct Depths {
  Eigen::MatrixXd least;   // F x 3P: (M^+ W)#
  Eigen::MatrixXd unseen;  // F x 3: n_f
  Eigen::Index points = 0;

  auto axis(Eigen::MatrixXd& m, Eigen::Index a) const { return m.middleCols(a * points, points); }
  auto axis(const Eigen::MatrixXd& m, Eigen::Index a) const { return m.middleCols(a * points, points); }
  // sum_a diag(n_a) m_a
  Eigen::MatrixXd along(const Eigen::MatrixXd& m) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(m.rows(), points);
    for (Eigen::Index a = 0; a < 3; ++a) sum += unseen.col(a).asDiagonal() * axis(m, a);
    return sum;
  }
  Eigen::MatrixXd lifted(const Eigen::MatrixXd& depths) const {
    Eigen::MatrixXd m(depths.rows(), 3 * points);
    for (Eigen::Index a = 0; a < 3; ++a) axis(m, a) = unseen.col(a).asDiagonal() * depths;
    return m;
  }
};

Depths depths_of(const LowRankProblem& problem) {
  const Eigen::Index frames = problem.w.rows() / 2;
  Depths result;
  result.points = problem.w.cols();
  result.unseen.resize(frames, 3);
  Shapes least(3 * frames, result.points);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const Eigen::Matrix<double, 2, 3> m = problem.rows.middleRows<2>(2 * f);
    result.unseen.row(f) = m.row(0).cross(m.row(1)).normalized();
    shape_of(least, f) = m.transpose() * (m * m.transpose()).inverse() * problem.w.middleRows<2>(2 * f);
  }
  result.least = rearranged(least);
  return result;
}

struct Thresholded {
  Eigen::MatrixXd m;
  Eigen::Index rank = 0;
};

// U (s - t)+ V' by way of the smaller Gram matrix: what it rounds away lies far below any threshold in use.
Thresholded thresholded(const Eigen::MatrixXd& m, double threshold) {
  const bool tall = m.rows() > m.cols();
  Eigen::MatrixXd gram;
  if (tall) {
    gram.noalias() = m.transpose() * m;
  } else {
    gram.noalias() = m * m.transpose();
  }
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(gram);
  const Eigen::VectorXd s = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
  Thresholded result;
  while (result.rank < s.size() && s(s.size() - 1 - result.rank) > threshold) ++result.rank;
  const Eigen::MatrixXd v = eigen.eigenvectors().rightCols(result.rank);
  const Eigen::VectorXd keep = 1 - threshold / s.tail(result.rank).array();
  if (tall) {
    result.m = (m * v) * keep.asDiagonal() * v.transpose();
  } else {
    result.m = v * keep.asDiagonal() * (v.transpose() * m);
  }
  return result;
}

// <Q, least> for the multiplier Q freed of what it has along the depths and shrunk into |Q|_2 <= 1.
double lower_bound(const Depths& depths, const Eigen::MatrixXd& multiplier) {
  const Eigen::MatrixXd q = multiplier - depths.lifted(depths.along(multiplier));
  const double norm = linear::DividedSvd(q).singularValues()(0);
  return norm > 0 ? q.cwiseProduct(depths.least).sum() / std::max(norm, 1.0) : 0;
}

class DepthStep {
 public:
  DepthStep(const LowRankProblem& problem, const Depths& depths) : problem_(problem), depths_(depths) {
    if (problem.laplacian.size() == 0) return;
    pull_ = Eigen::MatrixXd::Zero(problem.w.rows() / 2, depths.points);
    coupled_ = Eigen::MatrixXd::Zero(pull_.rows(), pull_.rows());
    for (Eigen::Index a = 0; a < 3; ++a) {
      const auto n = depths.unseen.col(a).asDiagonal();
      pull_ += n * (problem.laplacian * depths.axis(depths.least, a));
      coupled_ += n * problem.laplacian * n;
    }
  }
  void set_rho(double rho) {
    rho_ = rho;
    if (problem_.laplacian.size() == 0) return;
    Eigen::MatrixXd normal = problem_.coupling * coupled_;
    normal.diagonal().array() += rho;
    factor_ = linear::Llt(normal);
  }
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& target) const {
    Eigen::MatrixXd y = depths_.along(target);
    if (problem_.laplacian.size() > 0) y = factor_.solve(rho_ * y - problem_.coupling * pull_);
    return depths_.least + depths_.lifted(y);
  }

 private:
  const LowRankProblem& problem_;
  const Depths& depths_;
  double rho_ = 1;
  Eigen::MatrixXd pull_, coupled_;
  linear::Llt factor_;
};

}  // namespace

Eigen::MatrixXd rearranged(const Shapes& shapes) {
  const Eigen::Index frames = shapes.rows() / 3, points = shapes.cols();
  Eigen::MatrixXd rows(frames, 3 * points);
  for (Eigen::Index f = 0; f < frames; ++f) {
    for (Eigen::Index a = 0; a < 3; ++a) rows.block(f, a * points, 1, points) = shapes.row(3 * f + a);
  }
  return rows;
}

Shapes arranged(const Eigen::MatrixXd& rows) {
  const Eigen::Index frames = rows.rows(), points = rows.cols() / 3;
  Shapes shapes(3 * frames, points);
  for (Eigen::Index f = 0; f < frames; ++f) {
    for (Eigen::Index a = 0; a < 3; ++a) shapes.row(3 * f + a) = rows.block(f, a * points, 1, points);
  }
  return shapes;
}

LowRankShapes low_rank_shapes(const LowRankProblem& problem, const LowRankOptions& options, const Shapes& start) {
  const Depths depths = depths_of(problem);
  const double size = depths.least.norm();
  Eigen::MatrixXd s = start.size() > 0 ? rearranged(start) : depths.least;
  Eigen::MatrixXd z = s, u = Eigen::MatrixXd::Zero(s.rows(), s.cols());
  DepthStep depth_step(problem, depths);
  // 1 / rho is a threshold: at first a tenth of the largest singular value, of which size / 2 is a guess
  double rho = size > 0 ? 20 / size : 1;
  depth_step.set_rho(rho);
  LowRankShapes result;
  while (size > 0 && !result.converged && result.iterations < options.most_iterations) {
    throw_if_interrupted();
    Thresholded next = thresholded(s + u, 1 / rho);
    const double dual = (next.m - z).norm() / size;
    z = std::move(next.m);
    result.rank = next.rank;
    u += s - z;
    s = depth_step(z - u);
    const double primal = (s - z).norm() / size;
    ++result.iterations;
    result.converged = result.iterations > 1 && primal < options.tolerance && dual < options.tolerance;
    const double factor = primal > 5 * dual ? 1.6 : dual > 5 * primal ? 1 / 1.6 : 1;
    if (factor != 1 && !result.converged && result.iterations % 5 == 0) {
      rho *= factor;
      u /= factor;
      depth_step.set_rho(rho);
    }
  }
  result.converged = result.converged || size == 0;
  result.shapes = arranged(s);
  result.nuclear_norm = linear::DividedSvd(s).singularValues().sum();
  result.bound = problem.laplacian.size() > 0 ? 0 : lower_bound(depths, rho * u);
  return result;
}

}  // namespace gonio::nrsfm
