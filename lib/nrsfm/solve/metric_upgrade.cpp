// Metric upgrade of motion matrices. With a_f, b_f the two rows of M_f and A = a_f G, B = b_f G the residuals of a
// frame, over the square of its scale s, are
//   (|A|^2 - |B|^2) / sqrt(2),   sqrt(2) w ((|A|^2 + |B|^2) / 2 - s^2),   sqrt(2) A . B
// For w = 1 their squares add up to |M_f G G' M_f' - s^2 I|_F^2; for any w a turn of the image does not change their
// sum. Where scales are free w is small (it keeps frames from vanishing) and s follows the rows in a few rounds.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "linear/qr.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"
#include "nrsfm/solve/factorization.h"

namespace gonio::nrsfm {
namespace {

constexpr double kFreeScaleWeight = 0.1;
constexpr int kStartsAtLowRank = 6, kLowRank = 3;  // perturbed starts for ranks up to kLowRank; one beyond
constexpr std::size_t kBeam = 2;

struct Problem {
  Eigen::MatrixXd a, b;  // F x 3K
  Eigen::VectorXd squared_scales;
  double weight = 1;
};

Problem first_columns(const Problem& all, Eigen::Index columns) {
  return {all.a.leftCols(columns), all.b.leftCols(columns), all.squared_scales, all.weight};
}

struct Candidate {
  Eigen::MatrixXd transform;
  double cost = 0;
};

struct Residuals {
  Eigen::MatrixXd a, b;  // F x 3: rows times G
  Eigen::MatrixXd r;     // F x 3
  double cost = 0;
};

Residuals residuals_of(const Problem& problem, const Eigen::MatrixXd& transform) {
  Residuals at{problem.a * transform, problem.b * transform, {}, 0};
  const Eigen::ArrayXd aa = at.a.rowwise().squaredNorm(), bb = at.b.rowwise().squaredNorm();
  const Eigen::ArrayXd ab = at.a.cwiseProduct(at.b).rowwise().sum(), s2 = problem.squared_scales.array();
  at.r.resize(aa.size(), 3);
  at.r.col(0) = (aa - bb) / s2 / std::sqrt(2);
  at.r.col(1) = std::sqrt(2) * problem.weight * ((aa + bb) / 2 - s2) / s2;
  at.r.col(2) = std::sqrt(2) * ab / s2;
  at.cost = at.r.squaredNorm();
  return at;
}

// Rows 3f, 3f + 1, 3f + 2 for frame f; columns as G's, column by column.
Eigen::MatrixXd jacobian_of(const Problem& problem, const Residuals& at) {
  const Eigen::Index frames = problem.a.rows(), n = problem.a.cols();
  Eigen::MatrixXd jacobian(3 * frames, 3 * n);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double over = 1 / problem.squared_scales(f);
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto a = problem.a.row(f), b = problem.b.row(f);
      const double x = at.a(f, c), y = at.b(f, c);
      jacobian.block(3 * f, c * n, 1, n) = std::sqrt(2) * over * (x * a - y * b);
      jacobian.block(3 * f + 1, c * n, 1, n) = std::sqrt(2) * problem.weight * over * (x * a + y * b);
      jacobian.block(3 * f + 2, c * n, 1, n) = std::sqrt(2) * over * (y * a + x * b);
    }
  }
  return jacobian;
}

Candidate minimized(const Problem& problem, Eigen::MatrixXd transform, int most_iterations) {
  Residuals at = residuals_of(problem, transform);
  const Eigen::Index n = transform.rows();
  double damping = 1e-3;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    throw_if_interrupted();
    const Eigen::MatrixXd jacobian = jacobian_of(problem, at);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(jacobian.transpose());
    const Eigen::VectorXd r = at.r.transpose().reshaped();
    const Eigen::VectorXd gradient = jacobian.transpose() * r;
    const double floor = 1e-12 * normal.trace();
    bool better = false;
    double fall = 0;
    for (int tries = 0; tries < 12 && !better; ++tries) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal().array() += damping * (normal.diagonal().array() + floor) + 1e-300;
      const Eigen::VectorXd step = linear::solve_ldlt(damped, gradient);
      const Eigen::MatrixXd tried = transform - step.reshaped(n, 3);
      Residuals tried_at = residuals_of(problem, tried);
      better = tried_at.cost < at.cost;
      if (!better) {
        damping *= 4;
        continue;
      }
      fall = (at.cost - tried_at.cost) / at.cost;
      transform = tried;
      at = std::move(tried_at);
    }
    damping = std::max(damping / 8, 1e-15);
    if (!better || fall < 1e-9 || at.cost < 1e-28 * static_cast<double>(problem.a.rows())) break;
  }
  return {std::move(transform), at.cost};
}

// K = 1: least squares for the six numbers of Q = G G', its eigenvalues kept positive.
Eigen::Matrix3d linear_start(const Problem& problem) {
  constexpr std::array<std::array<int, 2>, 6> entries{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};
  const auto form = [&](const Eigen::RowVector3d& x, const Eigen::RowVector3d& y) {
    Eigen::RowVector<double, 6> row;
    for (int e = 0; e < 6; ++e) {
      const auto [i, j] = entries[static_cast<std::size_t>(e)];
      row(e) = i == j ? x(i) * y(j) : x(i) * y(j) + x(j) * y(i);
    }
    return row;
  };
  const Eigen::Index frames = problem.a.rows();
  Eigen::MatrixXd equations(3 * frames, 6);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(3 * frames);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const Eigen::RowVector3d a = problem.a.row(f).head<3>(), b = problem.b.row(f).head<3>();
    equations.row(3 * f) = (form(a, a) - form(b, b)) / std::sqrt(2);
    equations.row(3 * f + 1) = problem.weight * (form(a, a) + form(b, b)) / std::sqrt(2);
    equations.row(3 * f + 2) = std::sqrt(2) * form(a, b);
    right(3 * f + 1) = std::sqrt(2) * problem.weight;
  }
  const Eigen::VectorXd q = linear::PivotedQr(equations).solve(right);
  Eigen::Matrix3d gram;
  for (int e = 0; e < 6; ++e) {
    const auto [i, j] = entries[static_cast<std::size_t>(e)];
    gram(i, j) = gram(j, i) = q(e);
  }
  const linear::SymmetricEigen<Eigen::Matrix3d> eigen(gram);
  const double floor = 1e-6 * eigen.eigenvalues().cwiseAbs().maxCoeff();
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(floor).cwiseSqrt().asDiagonal();
}

void keep_lowest(std::vector<Candidate>& candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& x, const Candidate& y) { return x.cost < y.cost; });
  std::vector<Candidate> kept;
  for (Candidate& candidate : candidates) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Candidate& other) {
      return std::abs(candidate.cost - other.cost) <= 1e-4 * candidate.cost;
    });
    if (!known) kept.push_back(std::move(candidate));
    if (kept.size() == kBeam) break;
  }
  candidates = std::move(kept);
}

std::vector<Candidate> next_rank(const Problem& problem, const std::vector<Candidate>& before, Random& random) {
  const Eigen::Index n = problem.a.cols();
  const bool low = n <= 3 * kLowRank;
  std::vector<Candidate> next;
  for (const Candidate& candidate : before) {
    Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(n, 3);
    padded.topRows(candidate.transform.rows()) = candidate.transform;
    next.push_back(minimized(problem, padded, 60));
    const double spread = (low ? 0.7 : 0.3) * candidate.transform.cwiseAbs().maxCoeff();
    for (int k = 0; k < (low ? kStartsAtLowRank : 1); ++k) {
      const Eigen::MatrixXd moved = padded.unaryExpr([&](double x) { return x + spread * random.normal(); });
      next.push_back(minimized(problem, moved, 60));
    }
  }
  keep_lowest(next);
  return next;
}

// The squared scales that the rows themselves have, within a factor of 4 of their median scale.
Eigen::VectorXd scales_of(const Problem& problem, const Eigen::MatrixXd& transform) {
  const Residuals at = residuals_of(problem, transform);
  Eigen::VectorXd squared = (at.a.rowwise().squaredNorm() + at.b.rowwise().squaredNorm()) / 2;
  std::vector<double> sorted(squared.begin(), squared.end());
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double median = sorted[sorted.size() / 2];
  return squared.cwiseMax(median / 16).cwiseMin(16 * median) / median;
}

void follow_scales(Problem& all, std::vector<Candidate>& candidates) {
  const Eigen::Index n = candidates.front().transform.rows();
  for (int round = 0; round < 5; ++round) {
    all.squared_scales = scales_of(first_columns(all, n), candidates.front().transform);
    for (Candidate& candidate : candidates) candidate = minimized(first_columns(all, n), candidate.transform, 20);
  }
}

Upgrade upgrade_of(const Problem& problem, const Eigen::MatrixXd& start, bool free_scales) {
  const Candidate best = minimized(problem, start, 300);
  const Eigen::Index frames = problem.a.rows();
  Upgrade upgrade;
  upgrade.transform = best.transform;
  upgrade.residual = std::sqrt(best.cost / static_cast<double>(frames));
  upgrade.scales = Eigen::VectorXd::Ones(frames);
  if (free_scales) upgrade.scales = scales_of(problem, best.transform).cwiseSqrt();
  upgrade.scales /= upgrade.scales.mean();
  for (Eigen::Index f = 0; f < frames; ++f) {
    CameraRows rows;
    rows.row(0) = problem.a.row(f) * best.transform;
    rows.row(1) = problem.b.row(f) * best.transform;
    upgrade.rotations.push_back(nearest_rows(rows));
  }
  return upgrade;
}

}  // namespace

std::vector<Upgrade> metric_upgrades(const Eigen::MatrixXd& rows, const UpgradeOptions& options) {
  const Eigen::Index frames = rows.rows() / 2, terms = rows.cols() / 3;
  if (rows.col(2).norm() < 1e-7 * rows.col(0).norm()) {
    throw Error(Exit::data, "tracks", "all tracks are affine images of one plane: no view turns out of it",
                "a camera or an object that rotates in depth is needed");
  }
  Problem all;
  all.a = rows(Eigen::seqN(0, frames, 2), Eigen::all);
  all.b = rows(Eigen::seqN(1, frames, 2), Eigen::all);
  all.squared_scales = Eigen::VectorXd::Ones(frames);
  all.weight = options.free_scales ? kFreeScaleWeight : 1;
  Random random(options.seed, 0x0bde);
  std::vector<Candidate> candidates{{linear_start(all), 0}};
  candidates.front() = minimized(first_columns(all, 3), candidates.front().transform, 60);
  std::vector<Upgrade> upgrades;
  for (Eigen::Index k = 1; k <= terms; ++k) {
    if (k > 1) candidates = next_rank(first_columns(all, 3 * k), candidates, random);
    if (options.free_scales) follow_scales(all, candidates);
    upgrades.push_back(upgrade_of(first_columns(all, 3 * k), candidates.front().transform, options.free_scales));
  }
  return upgrades;
}

Upgrade metric_upgrade(const Eigen::MatrixXd& rows, const UpgradeOptions& options) {
  return metric_upgrades(rows, options).back();
}

}  // namespace gonio::nrsfm
