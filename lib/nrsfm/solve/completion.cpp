// Low-rank completion by variational principal components (Ilin & Raiko, JMLR 11 (2010), section 4.2):
//   w_fp = A_f b_p + t_f + n,   b_p ~ N(0, I_r),   rows of A_f ~ N(0, diag(g)),   n ~ N(0, v I_2)
// with posteriors N(b_p, X_p) and N(A_f, Y_f), Y_f for both rows of a frame. Sums over what is visible:
//   X_p = v (v I + sum_f (A_f' A_f + 2 Y_f))^-1,   b_p = X_p sum_f A_f' (w_fp - t_f) / v
//   Y_f = v (v diag(1/g) + sum_p (b_p b_p' + X_p))^-1,   A_f' = Y_f sum_p b_p (w_fp - t_f)' / v
//   v, g: the mean expected squares of residuals and of the columns of A
// Maximum likelihood (alternating least squares, v -> 0) extrapolates without bounds where a point is seen in few
// frames; the posteriors' spread keeps that in bounds, and shrinks columns that the tracks do not support. After each
// sweep the factors turn to their principal axes (E[b b'] = I, E[A'A] diagonal), without which it crawls (section 4.3).
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "linear/solve.h"
#include "linear/svd.h"
#include "linear/symmetric_eigen.h"
#include "nrsfm/solve/factorization.h"

namespace gonio::nrsfm {
namespace {

struct TwoFactors {
  Eigen::MatrixXd a;  // 2F x r
  Eigen::MatrixXd b;  // r x P
  Eigen::VectorXd t;  // 2F
  std::vector<Eigen::MatrixXd> spread_a, spread_b;
  Eigen::VectorXd prior;  // g
  double noise = 0;       // v
};

TwoFactors started(const Eigen::MatrixXd& w, Eigen::Index rank) {
  TwoFactors at;
  at.t = w.rowwise().mean();
  const Eigen::MatrixXd less = w.colwise() - at.t;
  const linear::DividedSvd svd(less, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const double root = std::sqrt(static_cast<double>(w.cols()));
  const double energy = less.squaredNorm() / static_cast<double>(less.size());
  at.a = svd.matrixU().leftCols(rank) * svd.singularValues().head(rank).asDiagonal() / root;
  at.b = root * svd.matrixV().leftCols(rank).transpose();
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(rank, rank);
  at.spread_a.assign(static_cast<std::size_t>(w.rows() / 2), none);
  at.spread_b.assign(static_cast<std::size_t>(w.cols()), none);
  at.prior = Eigen::VectorXd::Constant(rank, 1e3 * energy);
  at.noise = 0.01 * energy;
  return at;
}

// Second moments A_f' A_f + 2 Y_f.
Eigen::MatrixXd motion_square(const TwoFactors& at, Eigen::Index f) {
  const auto rows = at.a.middleRows<2>(2 * f);
  return rows.transpose() * rows + 2 * at.spread_a[static_cast<std::size_t>(f)];
}

void sweep_points(const Sequence& sequence, TwoFactors& at) {
  const Eigen::Index r = at.b.rows();
  std::vector<Eigen::MatrixXd> squares;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) squares.push_back(motion_square(at, f));
  for (Eigen::Index p = 0; p < sequence.points(); ++p) {
    Eigen::MatrixXd normal = at.noise * Eigen::MatrixXd::Identity(r, r);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(r);
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      if (!sequence.visible(f, p)) continue;
      normal += squares[static_cast<std::size_t>(f)];
      right.noalias() +=
          at.a.middleRows<2>(2 * f).transpose() * (sequence.tracks.block<2, 1>(2 * f, p) - at.t.segment<2>(2 * f));
    }
    const linear::Ldlt solver(normal);
    at.b.col(p) = solver.solve(right);
    at.spread_b[static_cast<std::size_t>(p)] = at.noise * solver.solve(Eigen::MatrixXd::Identity(r, r));
  }
}

// The same model with sum_p b_p = 0, E[b b'] = I and E[A'A] diagonal, in falling order.
void turn_to_axes(TwoFactors& at) {
  const Eigen::VectorXd mean = at.b.rowwise().mean();
  at.t += at.a * mean;
  at.b.colwise() -= mean;
  Eigen::MatrixXd square = at.b * at.b.transpose();
  for (const Eigen::MatrixXd& spread : at.spread_b) square += spread;
  const linear::SymmetricEigen<Eigen::MatrixXd> points(square / static_cast<double>(at.b.cols()));
  const Eigen::VectorXd roots = points.eigenvalues().cwiseMax(1e-300).cwiseSqrt();
  // Each product in a matrix of its own, as it is anyway: chains take a quarter longer to compile.
  const Eigen::MatrixXd whitened = points.eigenvectors() * roots.asDiagonal();
  Eigen::MatrixXd motion = ((whitened.transpose() * at.a.transpose()).eval() * at.a).eval() * whitened;
  for (const Eigen::MatrixXd& spread : at.spread_a) motion += (2 * whitened.transpose() * spread).eval() * whitened;
  const Eigen::MatrixXd axes = linear::SymmetricEigen<Eigen::MatrixXd>(motion).eigenvectors().rowwise().reverse();
  const Eigen::MatrixXd back = whitened * axes;
  const Eigen::MatrixXd forth =
      (axes.transpose() * roots.cwiseInverse().asDiagonal()).eval() * points.eigenvectors().transpose();
  at.a = (at.a * back).eval();
  at.b = (forth * at.b).eval();
  for (Eigen::MatrixXd& spread : at.spread_a) spread = ((back.transpose() * spread).eval() * back).eval();
  for (Eigen::MatrixXd& spread : at.spread_b) spread = ((forth * spread).eval() * forth.transpose()).eval();
}

// A, t; then v and g from the expected squares.
void sweep_frames(const Sequence& sequence, TwoFactors& at) {
  const Eigen::Index r = at.b.rows();
  std::vector<Eigen::MatrixXd> squares;
  for (Eigen::Index p = 0; p < sequence.points(); ++p)
    squares.push_back(at.b.col(p) * at.b.col(p).transpose() + at.spread_b[static_cast<std::size_t>(p)]);
  Eigen::VectorXd columns = Eigen::VectorXd::Zero(r);
  double sum = 0;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    Eigen::MatrixXd square = Eigen::MatrixXd::Zero(r, r), spread = square, right = Eigen::MatrixXd::Zero(r, 2);
    for (Eigen::Index p = 0; p < sequence.points(); ++p) {
      if (!sequence.visible(f, p)) continue;
      square += squares[static_cast<std::size_t>(p)];
      spread += at.spread_b[static_cast<std::size_t>(p)];
      right += at.b.col(p) * (sequence.tracks.block<2, 1>(2 * f, p) - at.t.segment<2>(2 * f)).transpose();
    }
    Eigen::MatrixXd normal = square;
    normal.diagonal() += at.noise * at.prior.cwiseInverse();
    const linear::Ldlt solver(normal);
    at.a.middleRows<2>(2 * f) = solver.solve(right).transpose();
    Eigen::MatrixXd& own = at.spread_a[static_cast<std::size_t>(f)];
    own = at.noise * solver.solve(Eigen::MatrixXd::Identity(r, r));
    const Eigen::MatrixXd rows = at.a.middleRows<2>(2 * f);
    Eigen::Matrix2Xd residual(2, sequence.points());
    Eigen::Index seen = 0;
    for (Eigen::Index p = 0; p < sequence.points(); ++p)
      if (sequence.visible(f, p)) residual.col(seen++) = sequence.tracks.block<2, 1>(2 * f, p) - rows * at.b.col(p);
    at.t.segment<2>(2 * f) = residual.leftCols(seen).rowwise().mean();
    sum += (residual.leftCols(seen).colwise() - at.t.segment<2>(2 * f)).squaredNorm();
    sum += (rows.transpose() * rows).cwiseProduct(spread).sum() + 2 * own.cwiseProduct(square).sum();
    columns += rows.colwise().squaredNorm().transpose() + 2 * own.diagonal();
  }
  at.noise = std::max(sum / (2 * static_cast<double>(sequence.visible.count())), 1e-300);
  at.prior = (columns / static_cast<double>(2 * sequence.frames())).cwiseMax(1e-300);
}

}  // namespace

void require_seen(const Sequence& sequence, Eigen::Index rank) {
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
  require_seen(sequence, 3);
  const Eigen::MatrixXd w = interpolated(sequence);
  TwoFactors at = started(w, rank);
  const double floor = 1e-26 * at.noise;
  Completion result;
  for (; result.iterations < most_iterations && !result.converged; ++result.iterations) {
    throw_if_interrupted();
    const double before = at.noise;
    sweep_points(sequence, at);
    turn_to_axes(at);
    sweep_frames(sequence, at);
    result.converged = result.iterations > 20 && (std::abs(before - at.noise) <= 1e-5 * before || at.noise <= floor);
  }
  const Eigen::VectorXd middle = at.b.rowwise().mean();  // t is the mean of all points, seen or not
  at.b.colwise() -= middle;
  result.translation = at.t + at.a * middle;
  result.w = at.a * at.b;
  for (Eigen::Index row = 0; row < w.rows(); ++row) {
    const auto measured = (w.row(row).array() - result.translation(row)).eval();
    result.w.row(row) = sequence.visible.row(row / 2).select(measured, result.w.row(row).array());
  }
  return result;
}

Eigen::Index completion_rank(const Sequence& sequence, double share, Eigen::Index most) {
  require_seen(sequence, 3);
  Sequence less = sequence;  // without one visible track in twenty
  Random random(1, 0x4e1d);
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    for (Eigen::Index p = 0; p < sequence.points(); ++p) {
      const bool spare = less.visible.row(f).count() > 4 && less.visible.col(p).count() > 2;
      if (less.visible(f, p) && spare && random.uniform() < 0.05) less.visible(f, p) = false;
    }
  }
  const Eigen::MatrixXd w = interpolated(sequence);
  const double energy = (w.colwise() - w.rowwise().mean()).squaredNorm() / static_cast<double>(w.size());
  const double enough = std::max(share * share * energy, std::pow(noise_of(w), 2));
  double least = std::numeric_limits<double>::infinity();
  Eigen::Index chosen = 1;
  for (Eigen::Index terms = 1; terms <= most && 3 * terms <= std::min(w.cols() - 1, w.rows()); ++terms) {
    const Completion filled = complete(less, 3 * terms, 30);
    double sum = 0, count = 1e-300;
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      for (Eigen::Index p = 0; p < sequence.points(); ++p) {
        if (less.visible(f, p) || !sequence.visible(f, p)) continue;
        const Eigen::Vector2d there = filled.w.block<2, 1>(2 * f, p) + filled.translation.segment<2>(2 * f);
        sum += (there - w.block<2, 1>(2 * f, p)).squaredNorm() / 2;
        ++count;
      }
    }
    if (sum / count < 0.8 * least) chosen = terms;
    least = std::min(least, sum / count);
    if (sum / count <= enough || terms >= chosen + 2) break;
  }
  return chosen;
}

}  // namespace gonio::nrsfm
