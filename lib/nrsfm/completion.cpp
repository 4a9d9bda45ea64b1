// Low-rank completion by alternating least squares: with W ~ A B + t 1', each row's (a, t) and each column's b is a
// small ridge problem over the visible entries. Alternation crawls along valleys; every few sweeps a step along the
// last sweep's direction is tried and kept where it lowers the residual.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/atomic_file.h"
#include "base/error.h"
#include "nrsfm/factorization.h"

namespace gonio::nrsfm {
namespace {

void check_seen(const Sequence& sequence, Eigen::Index rank) {
  const Eigen::Index frames_needed = (rank + 1) / 2;
  for (Eigen::Index p = 0; p < sequence.points(); ++p) {
    const Eigen::Index seen = sequence.visible.col(p).count();
    if (seen >= frames_needed) continue;
    throw Error(Exit::data, "tracks",
                "point " + std::to_string(p + 1) + " is seen in " + std::to_string(seen) + " frames, and rank " +
                    std::to_string(rank) + " needs " + std::to_string(frames_needed),
                "leave the point out, or take a lower rank");
  }
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    const Eigen::Index seen = sequence.visible.row(f).count();
    if (seen >= rank + 1) continue;
    throw Error(Exit::data, "tracks",
                "frame " + std::to_string(f + 1) + " sees " + std::to_string(seen) + " points, and rank " +
                    std::to_string(rank) + " needs " + std::to_string(rank + 1),
                "leave the frame out, or take a lower rank");
  }
}

struct TwoFactors {
  Eigen::MatrixXd a;  // 2F x (r + 1), the last column t
  Eigen::MatrixXd b;  // (r + 1) x P, the last row 1
};

double cost_of(const Sequence& sequence, const Eigen::MatrixXd& w, const TwoFactors& at) {
  const Eigen::ArrayXXd residual = (w - at.a * at.b).array();
  double cost = 0;
  for (Eigen::Index row = 0; row < w.rows(); ++row) {
    cost += sequence.visible.row(row / 2).select(residual.row(row), 0.0).square().sum();
  }
  return cost;
}

void solve_columns(const Sequence& sequence, const Eigen::MatrixXd& w, double ridge, TwoFactors& at) {
  const Eigen::Index r = at.b.rows() - 1;
  for (Eigen::Index p = 0; p < w.cols(); ++p) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(r, r) * ridge;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(r);
    for (Eigen::Index row = 0; row < w.rows(); ++row) {
      if (!sequence.visible(row / 2, p)) continue;
      const auto a = at.a.row(row).head(r);
      normal.noalias() += a.transpose() * a;
      right.noalias() += a.transpose() * (w(row, p) - at.a(row, r));
    }
    at.b.col(p).head(r) = normal.ldlt().solve(right);
  }
}

void solve_rows(const Sequence& sequence, const Eigen::MatrixXd& w, double ridge, TwoFactors& at) {
  const Eigen::Index n = at.b.rows();
  for (Eigen::Index f = 0; f < w.rows() / 2; ++f) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(n, n) * ridge, right = Eigen::MatrixXd::Zero(n, 2);
    for (Eigen::Index p = 0; p < w.cols(); ++p) {
      if (!sequence.visible(f, p)) continue;
      normal.noalias() += at.b.col(p) * at.b.col(p).transpose();
      right.noalias() += at.b.col(p) * w.block<2, 1>(2 * f, p).transpose();
    }
    at.a.middleRows<2>(2 * f) = normal.ldlt().solve(right).transpose();
  }
}

}  // namespace

// Each track interpolated over time between the frames that see it, held before the first and after the last.
Eigen::MatrixXd interpolated(const Sequence& sequence) {
  Eigen::MatrixXd w = sequence.tracks;
  for (Eigen::Index p = 0; p < sequence.points(); ++p) {
    Eigen::Index last = -1;
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      if (!sequence.visible(f, p)) continue;
      const auto here = sequence.tracks.block<2, 1>(2 * f, p);
      for (Eigen::Index g = last + 1; g < f; ++g) {
        const double t = last < 0 ? 1 : static_cast<double>(g - last) / static_cast<double>(f - last);
        const Eigen::Index from = last < 0 ? f : last;
        w.block<2, 1>(2 * g, p) = (1 - t) * sequence.tracks.block<2, 1>(2 * from, p) + t * here;
      }
      last = f;
    }
    for (Eigen::Index g = last + 1; g < sequence.frames(); ++g) {
      w.block<2, 1>(2 * g, p) = sequence.tracks.block<2, 1>(2 * last, p);
    }
  }
  return w;
}

Completion complete(const Sequence& sequence, Eigen::Index rank, int most_iterations) {
  check_seen(sequence, rank);
  const Eigen::MatrixXd w = interpolated(sequence);
  TwoFactors at;
  at.a.resize(w.rows(), rank + 1);
  at.a.col(rank) = w.rowwise().mean();
  const Eigen::MatrixXd less = w.colwise() - at.a.col(rank);
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(less, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd roots = svd.singularValues().head(rank).cwiseSqrt();
  at.a.leftCols(rank) = svd.matrixU().leftCols(rank) * roots.asDiagonal();
  at.b = Eigen::MatrixXd::Ones(rank + 1, w.cols());
  at.b.topRows(rank) = roots.asDiagonal() * svd.matrixV().leftCols(rank).transpose();
  const double ridge = 1e-10 * std::max(svd.singularValues()(0), 1e-300);

  Completion result;
  const double energy = less.squaredNorm();
  double cost = cost_of(sequence, w, at), stride = 2;
  for (; result.iterations < most_iterations && !result.converged; ++result.iterations) {
    throw_if_interrupted();
    const TwoFactors before = at;
    const double cost_before = cost;
    solve_columns(sequence, w, ridge, at);
    solve_rows(sequence, w, ridge, at);
    cost = cost_of(sequence, w, at);
    TwoFactors further{before.a + stride * (at.a - before.a), before.b + stride * (at.b - before.b)};
    const double further_cost = cost_of(sequence, w, further);
    if (further_cost < cost) {
      at = std::move(further);
      cost = further_cost;
      stride = std::min(1.5 * stride, 100.0);
    } else {
      stride = std::max(0.7 * stride, 1.5);
    }
    result.converged = cost_before - cost <= 1e-9 * cost_before || cost <= 1e-26 * energy;
  }
  const Eigen::VectorXd middle = at.b.topRows(rank).rowwise().mean();  // t is the mean of all points, seen or not
  at.b.topRows(rank).colwise() -= middle;
  result.translation = at.a.col(rank) + at.a.leftCols(rank) * middle;
  result.w = at.a.leftCols(rank) * at.b.topRows(rank);
  for (Eigen::Index row = 0; row < w.rows(); ++row) {
    const auto measured = (w.row(row).array() - result.translation(row)).eval();
    result.w.row(row) = sequence.visible.row(row / 2).select(measured, result.w.row(row).array());
  }
  return result;
}

}  // namespace gonio::nrsfm
