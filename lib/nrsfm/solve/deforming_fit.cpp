// See deforming_fit.h. With n = 1 / (1 + kappa q_z) and U = q_xy + t - c0, D = du/dq = [n I | -kappa n^2 U]:
//   du/dw = -D [q]x   (a turn on the left of R),   du/dt = n I,   du/dc_k = D R b_k,   du/db_k = c_k D R,
//   du/dkappa = -n^2 q_z U.
#include "nrsfm/solve/deforming_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "linear/solve.h"
#include "linear/svd.h"

namespace gonio::nrsfm {
namespace {

constexpr double nearest = 0.1;       // of 1 + kappa q_z: nobody stands nearer
constexpr double point_ridge = 1e-9;  // of the trace over the size, where frames do not determine a point
constexpr double least_damping = 1e-7, first_damping = 1e-3, most_damping = 1e6;
constexpr int rounds_of_points = 2, rounds_of_a_shape = 20;

using TwoRows = Eigen::Matrix<double, 2, Eigen::Dynamic>;

Eigen::Matrix3d crossed(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

struct Slopes {  // of one observation
  Eigen::Vector2d residual, by_kappa;
  Eigen::Matrix<double, 2, 3> by_place, by_turn;
  double by_shift = 1;
};

Slopes slopes_of(const UsedTracks& tracks, const DeformingShape& s, Eigen::Index f, Eigen::Index p) {
  const Eigen::Vector3d q = s.place(f, p);
  const double n = 1 / std::max(nearest, 1 + s.kappa * q.z());
  const Eigen::Vector2d u = q.head<2>() + s.shift.col(f) - s.centre;
  Slopes d;
  d.residual = tracks.tracks.block<2, 1>(2 * f, p) - s.centre - n * u;
  d.by_place.leftCols<2>() = n * Eigen::Matrix2d::Identity();
  d.by_place.col(2) = -s.kappa * n * n * u;
  d.by_turn = -d.by_place * crossed(q);
  d.by_kappa = -n * n * q.z() * u;
  d.by_shift = n;
  return d;
}

// 2 x 3K: with respect to the shapes of one point.
TwoRows by_shapes(const DeformingShape& s, Eigen::Index f, const Slopes& d) {
  const Eigen::Matrix<double, 2, 3> turned = d.by_place * s.rotation[static_cast<std::size_t>(f)];
  TwoRows rows(2, 3 * s.terms());
  for (Eigen::Index k = 0; k < s.terms(); ++k) rows.middleCols<3>(3 * k) = s.weights(f, k) * turned;
  return rows;
}

// 2 x (5 + K): with respect to the numbers of one frame.
TwoRows by_frame(const DeformingShape& s, Eigen::Index f, Eigen::Index p, const Slopes& d) {
  const Eigen::Map<const Eigen::Matrix3Xd> b(s.basis.col(p).data(), 3, s.terms());
  TwoRows rows(2, 5 + s.terms());
  rows << d.by_turn, d.by_shift * Eigen::Matrix2d::Identity(),
      d.by_place * (s.rotation[static_cast<std::size_t>(f)] * b);
  return rows;
}

linear::Llt ridged(Eigen::MatrixXd normal) {
  const double least = point_ridge * normal.trace() / static_cast<double>(normal.rows());
  normal.diagonal().array() += least > 0 ? least : 1.0;
  return linear::Llt(normal);
}

// The points where the frames put them, by Gauss-Newton; exact in one round without perspective.
void settle_points(const UsedTracks& tracks, DeformingShape& s) {
  const Eigen::Index n = 3 * s.terms();
  for (Eigen::Index p = 0; p < s.basis.cols(); ++p)
    for (int round = 0; round < (s.kappa == 0 ? 1 : rounds_of_points); ++round) {
      Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
      Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
      for (Eigen::Index f = 0; f < tracks.used.rows(); ++f) {
        if (!(tracks.used(f, p) > 0)) continue;
        const Slopes d = slopes_of(tracks, s, f, p);
        const TwoRows m = by_shapes(s, f, d);
        normal.noalias() += m.transpose() * m;
        right.noalias() += m.transpose() * d.residual;
      }
      s.basis.col(p) += ridged(normal).solve(right);
    }
}

double squares_of(const UsedTracks& tracks, const DeformingShape& s) {
  double sum = 0;
  for (Eigen::Index p = 0; p < tracks.used.cols(); ++p)
    for (Eigen::Index f = 0; f < tracks.used.rows(); ++f) {
      if (!(tracks.used(f, p) > 0)) continue;
      const Eigen::Vector3d q = s.place(f, p);
      const double near = 1 + s.kappa * q.z();
      if (!(near > nearest)) return std::numeric_limits<double>::infinity();
      sum += (tracks.tracks.block<2, 1>(2 * f, p) - s.centre - (q.head<2>() + s.shift.col(f) - s.centre) / near)
                 .squaredNorm();
    }
  return sum;
}

// Normal equations of the frames' numbers and kappa (last), the points eliminated.
struct Reduced {
  Eigen::MatrixXd matrix;        // lower triangle
  Eigen::VectorXd right, whole;  // whole: diagonal before elimination
};

Reduced reduced_equations(const UsedTracks& tracks, const DeformingShape& s) {
  const Eigen::Index frames = tracks.used.rows(), points = tracks.used.cols(), own = 5 + s.terms();
  const Eigen::Index size = frames * own + 1, n = 3 * s.terms();
  Reduced r{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), {}};
  Eigen::MatrixXd eliminated(n * points, size);
  Eigen::VectorXd eliminated_right(n * points);
  for (Eigen::Index p = 0; p < points; ++p) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n), coupling = Eigen::MatrixXd::Zero(n, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (Eigen::Index f = 0; f < frames; ++f) {
      if (!(tracks.used(f, p) > 0)) continue;
      const Slopes d = slopes_of(tracks, s, f, p);
      const TwoRows m = by_shapes(s, f, d), g = by_frame(s, f, p, d);
      normal.noalias() += m.transpose() * m;
      right.noalias() += m.transpose() * d.residual;
      coupling.middleCols(f * own, own).noalias() = m.transpose() * g;
      coupling.col(size - 1).noalias() += m.transpose() * d.by_kappa;
      r.matrix.block(f * own, f * own, own, own).noalias() += g.transpose() * g;
      r.matrix.block(size - 1, f * own, 1, own).noalias() += d.by_kappa.transpose() * g;
      r.matrix(size - 1, size - 1) += d.by_kappa.squaredNorm();
      r.right.segment(f * own, own).noalias() += g.transpose() * d.residual;
      r.right(size - 1) += d.by_kappa.dot(d.residual);
    }
    const linear::Llt factor = ridged(std::move(normal));
    coupling = factor.solve_lower(coupling);
    right = factor.solve_lower(right);
    eliminated.middleRows(n * p, n) = coupling;
    eliminated_right.segment(n * p, n) = right;
  }
  r.whole = r.matrix.diagonal();
  r.matrix.selfadjointView<Eigen::Lower>().rankUpdate(eliminated.transpose(), -1);
  r.right.noalias() -= eliminated.transpose() * eliminated_right;
  return r;
}

// The step of the frames' numbers and of kappa, which is last.
Eigen::VectorXd step_of(const Reduced& r, double damping, bool perspective) {
  Eigen::MatrixXd matrix = r.matrix;
  Eigen::VectorXd right = r.right;
  const double typical = r.whole.head(r.whole.size() - 1).mean();
  matrix.diagonal().array() += damping * r.whole.array() + 1e-12 * typical;
  const Eigen::Index last = right.size() - 1;
  if (perspective && r.whole(last) > 0) return linear::Llt(matrix).solve(right);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(right.size());
  step.head(last) = linear::Llt(matrix.topLeftCorner(last, last)).solve(right.head(last));
  return step;
}

DeformingShape moved(const UsedTracks& tracks, const DeformingShape& s, const Eigen::VectorXd& step) {
  DeformingShape next = s;
  const Eigen::Index own = 5 + s.terms();
  for (Eigen::Index f = 0; f < s.weights.rows(); ++f) {
    const auto part = step.segment(f * own, own);
    const Eigen::Vector3d turn = part.head<3>();
    Eigen::Matrix3d& rotation = next.rotation[static_cast<std::size_t>(f)];
    if (const double angle = turn.norm(); angle > 0)
      rotation = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * rotation;
    next.shift.col(f) += part.segment<2>(3);
    next.weights.row(f) += part.tail(s.terms()).transpose();
  }
  next.kappa += step(step.size() - 1);
  settle_points(tracks, next);
  return next;
}

}  // namespace

Eigen::Vector3d DeformingShape::place(Eigen::Index f, Eigen::Index p) const {
  const Eigen::Map<const Eigen::Matrix3Xd> b(basis.col(p).data(), 3, terms());
  return rotation[static_cast<std::size_t>(f)] * (b * weights.row(f).transpose());
}

double DeformingShape::depth() const {
  double largest = 0;
  for (Eigen::Index f = 0; f < weights.rows(); ++f) {
    Eigen::Matrix3Xd q(3, basis.cols());
    for (Eigen::Index p = 0; p < q.cols(); ++p) q.col(p) = place(f, p);
    const Eigen::Vector3d middle = q.rowwise().mean();
    largest = std::max(largest, (q.row(2).array() - middle.z()).abs().maxCoeff() / std::abs(1 + kappa * middle.z()));
  }
  return largest;
}

Eigen::MatrixXd residuals(const UsedTracks& tracks, const DeformingShape& shape) {
  Eigen::MatrixXd r = Eigen::MatrixXd::Zero(tracks.tracks.rows(), tracks.tracks.cols());
  for (Eigen::Index p = 0; p < r.cols(); ++p)
    for (Eigen::Index f = 0; f < tracks.used.rows(); ++f)
      if (tracks.used(f, p) > 0) r.block<2, 1>(2 * f, p) = slopes_of(tracks, shape, f, p).residual;
  return r;
}

DeformingFit fit_deforming(const UsedTracks& tracks, DeformingShape start, const DeformingFitOptions& options) {
  settle_points(tracks, start);
  DeformingFit fit{std::move(start), 0, 0};
  fit.squares = squares_of(tracks, fit.shape);
  double damping = first_damping;
  for (bool going = true; going && fit.steps < options.most_steps; ++fit.steps) {
    const Reduced r = reduced_equations(tracks, fit.shape);
    for (going = false; damping < most_damping; damping *= 8) {
      DeformingShape next = moved(tracks, fit.shape, step_of(r, damping, options.perspective));
      const double squares = squares_of(tracks, next);
      if (!(squares < fit.squares)) continue;
      going = fit.squares - squares > options.tolerance * fit.squares;
      fit.squares = squares;
      fit.shape = std::move(next);
      damping = std::max(least_damping, damping / 8);
      break;
    }
  }
  return fit;
}

PerspectiveColumn perspective_column(const UsedTracks& tracks, const DeformingShape& s) {
  PerspectiveColumn column{Eigen::MatrixXd::Zero(tracks.tracks.rows(), tracks.tracks.cols()), {}};
  const Reduced r = reduced_equations(tracks, s);
  const Eigen::Index last = r.right.size() - 1, own = 5 + s.terms(), n = 3 * s.terms();
  Eigen::MatrixXd matrix = r.matrix.topLeftCorner(last, last);
  matrix.diagonal().array() += 1e-9 * r.whole.head(last).array() + 1e-12 * r.whole.head(last).mean();
  const Eigen::VectorXd frames = linear::Llt(matrix).solve(r.matrix.row(last).head(last).transpose());
  column.surviving = column.whole;
  for (Eigen::Index p = 0; p < tracks.used.cols(); ++p) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    std::vector<std::pair<Eigen::Index, TwoRows>> rows;
    for (Eigen::Index f = 0; f < tracks.used.rows(); ++f) {
      if (!(tracks.used(f, p) > 0)) continue;
      const Slopes d = slopes_of(tracks, s, f, p);
      rows.emplace_back(f, by_shapes(s, f, d));
      column.whole.block<2, 1>(2 * f, p) = d.by_kappa;
      column.surviving.block<2, 1>(2 * f, p) = d.by_kappa - by_frame(s, f, p, d) * frames.segment(f * own, own);
      normal.noalias() += rows.back().second.transpose() * rows.back().second;
      right.noalias() += rows.back().second.transpose() * column.surviving.block<2, 1>(2 * f, p);
    }
    const Eigen::VectorXd of_point = ridged(std::move(normal)).solve(right);
    for (const auto& [f, m] : rows) column.surviving.block<2, 1>(2 * f, p) -= m * of_point;
  }
  return column;
}

// The residuals e as w_f R_f b_p, by turns from their singular vectors over time; the best of three.
DeformingShape with_further_shape(const UsedTracks& tracks, DeformingShape s) {
  const Eigen::Index frames = tracks.used.rows(), points = tracks.used.cols();
  const Eigen::MatrixXd e = residuals(tracks, s);
  Eigen::MatrixXd in_time(frames, 2 * points);
  for (Eigen::Index f = 0; f < frames; ++f) in_time.row(f) = e.middleRows<2>(2 * f).reshaped().transpose();
  const linear::DividedSvd svd(in_time, Eigen::ComputeThinU);
  double most = -1;
  Eigen::VectorXd best_weights;
  Eigen::Matrix3Xd best_shape;
  for (Eigen::Index start = 0; start < std::min<Eigen::Index>(3, svd.matrixU().cols()); ++start) {
    Eigen::VectorXd w = svd.matrixU().col(start);
    Eigen::Matrix3Xd b = Eigen::Matrix3Xd::Zero(3, points);
    double taken = 0;
    for (int round = 0; round < rounds_of_a_shape; ++round) {
      Eigen::Matrix3d normal = 1e-12 * Eigen::Matrix3d::Identity();
      b.setZero();
      for (Eigen::Index f = 0; f < frames; ++f) {
        const Eigen::Matrix<double, 2, 3> camera = s.rotation[static_cast<std::size_t>(f)].topRows<2>();
        normal += w(f) * w(f) * camera.transpose() * camera;
        b += w(f) * camera.transpose() * e.middleRows<2>(2 * f);
      }
      b = linear::solve_ldlt(normal, b).eval();
      taken = 0;
      for (Eigen::Index f = 0; f < frames; ++f) {
        const Eigen::Matrix2Xd seen = s.rotation[static_cast<std::size_t>(f)].topRows<2>() * b;
        const double energy = seen.squaredNorm(), dot = seen.cwiseProduct(e.middleRows<2>(2 * f)).sum();
        w(f) = energy > 0 ? dot / energy : 0;
        taken += energy > 0 ? dot * dot / energy : 0;
      }
    }
    if (!(taken > most)) continue;
    most = taken, best_weights = w, best_shape = b;
  }
  const double size = std::sqrt(best_weights.squaredNorm() / static_cast<double>(frames));
  s.weights.conservativeResize(Eigen::NoChange, s.terms() + 1);
  s.weights.rightCols<1>() = best_weights / (size > 0 ? size : 1);
  Eigen::MatrixXd basis(s.basis.rows() + 3, points);
  basis << s.basis, size * best_shape;
  s.basis = std::move(basis);
  return s;
}

}  // namespace gonio::nrsfm
