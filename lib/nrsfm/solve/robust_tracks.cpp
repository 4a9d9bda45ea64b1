// See robust_tracks.h.
#include "nrsfm/solve/robust_tracks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "linear/qr.h"
#include "linear/solve.h"
#include "linear/svd.h"
#include "nrsfm/solve/factorization.h"
#include "stats/intervals.h"

namespace gonio::nrsfm {
namespace {

constexpr int rounds_of_distances = 10, rounds_of_biweight = 10, rounds_of_squares = 4, rounds_of_remainder = 5;
constexpr Eigen::Index most_remainder = 12, points_a_term = 3;  // rank of A C, no more than a third of the points
constexpr double least_component = 1;                           // sigmas: a smaller singular value of A C is none
constexpr double biweight_reach = 5.5;                          // sigmas; 95 % efficient in two dimensions
constexpr double least_distance = 0.5;                          // sigmas: nearer ones weigh no more
constexpr double most_leverage = 0.95;
constexpr double nearest = 0.1, most_perspective = 0.8;  // of 1 + kappa s q_z; of kappa times the largest radius

Eigen::Matrix3d turned_by(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

}  // namespace

RobustTracks::RobustTracks(const Solved& solved) : model_(solved_model(solved, true)) {
  const Eigen::Index frames = model_.frame_count(), points = model_.point_count();
  tracks_.resize(2 * frames, points);
  seen_.resize(frames, points);
  for (Eigen::Index f = 0; f < frames; ++f)
    for (Eigen::Index p = 0; p < points; ++p) {
      const Eigen::Index frame = model_.frames[static_cast<std::size_t>(f)];
      const Eigen::Index point = model_.points[static_cast<std::size_t>(p)];
      seen_(f, p) = solved.sequence.visible(frame, point);
      tracks_.block<2, 1>(2 * f, p) = solved.sequence.tracks.block<2, 1>(2 * frame, point);
    }
  weights_over_time_ = model_.omega * model_.x;
  shapes_.resize(3 * model_.terms(), points);
  for (Eigen::Index p = 0; p < points; ++p) shapes_.col(p) = model_.basis[static_cast<std::size_t>(p)].reshaped();
  weight_ = seen_.cast<double>();
  leverage_ = Eigen::ArrayXXd::Zero(frames, points);
  const Eigen::Index q = std::min({most_remainder, points / points_a_term, frames / points_a_term});
  a_ = Eigen::MatrixXd::Zero(2 * frames, q);
  c_ = Eigen::MatrixXd::Zero(q, points);
  const double price = std::sqrt(static_cast<double>(2 * frames)) + std::sqrt(static_cast<double>(points));
  for (int round = 0; round < rounds_of_distances + rounds_of_biweight; ++round) {
    const bool least_distances = round < rounds_of_distances;
    fit_points();
    fit_frames();
    fit_perspective();
    if (round == rounds_of_distances) truncate();
    if (round > 0) fit_residual_structure(least_distances ? price * typical() : 0);
    reweigh(least_distances);
  }
  find_leverages();
}

void RobustTracks::refit(const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>& outside) {
  weight_ = (seen_ && !outside).cast<double>();
  for (int round = 0; round < rounds_of_squares; ++round) {
    fit_points();
    fit_frames();
    fit_perspective();
    fit_residual_structure(0);
  }
  find_leverages();
}

double RobustTracks::freedom() const {
  const double frames = static_cast<double>(model_.frame_count()), points = static_cast<double>(model_.point_count());
  const double numbers = 6 * frames + static_cast<double>(shapes_.size()) +
                         static_cast<double>(a_.cols()) * (2 * frames + points - static_cast<double>(a_.cols()));
  return std::max(4.0, static_cast<double>(seen_.count()) - numbers / 2);
}

// Components of A C that have shrunk to nothing go.
void RobustTracks::truncate() {
  if (a_.cols() == 0) return;
  const linear::HouseholderQr of_a(a_), of_c(c_.transpose());
  const Eigen::Index q = a_.cols();
  const Eigen::MatrixXd &qa = of_a.thin_q(), &qc = of_c.thin_q();
  const linear::JacobiSvd<Eigen::MatrixXd> svd(qa.transpose() * a_ * c_ * qc,
                                               Eigen::ComputeThinU | Eigen::ComputeThinV);
  Eigen::Index kept = 0;
  while (kept < q && svd.singularValues()(kept) > least_component * typical()) ++kept;
  const Eigen::VectorXd roots = svd.singularValues().head(kept).cwiseSqrt();
  a_ = qa * svd.matrixU().leftCols(kept) * roots.asDiagonal();
  c_ = roots.asDiagonal() * (qc * svd.matrixV().leftCols(kept)).transpose();
}

// A C to the model's residuals, from where it stands; at first from their largest singular vectors.
void RobustTracks::fit_residual_structure(double ridge) {
  const Eigen::Index frames = model_.frame_count(), points = model_.point_count(), q = a_.cols();
  if (q == 0) return;
  Eigen::MatrixXd e = Eigen::MatrixXd::Zero(2 * frames, points);
  for (Eigen::Index f = 0; f < frames; ++f)
    for (Eigen::Index p = 0; p < points; ++p)
      if (weight_(f, p) > 0) e.block<2, 1>(2 * f, p) = residual(f, p) + remainder(f, p);
  if (c_.squaredNorm() == 0) {
    const linear::DividedSvd svd(e, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd roots = svd.singularValues().head(q).cwiseSqrt();
    c_ = roots.asDiagonal() * svd.matrixV().leftCols(q).transpose();
    a_ = svd.matrixU().leftCols(q) * roots.asDiagonal();
  }
  const auto solve = [q, ridge](Eigen::MatrixXd normal, const Eigen::MatrixXd& right) -> Eigen::MatrixXd {
    const double least = 1e-9 * normal.trace() / static_cast<double>(q);
    normal.diagonal().array() += ridge + (least > 0 ? least : 1.0);
    return linear::solve_ldlt(normal, right);
  };
  for (int round = 0; round < rounds_of_remainder; ++round) {
    for (Eigen::Index f = 0; f < frames; ++f) {
      const Eigen::MatrixXd weighted = c_ * weight_.row(f).matrix().asDiagonal();
      a_.middleRows<2>(2 * f) =
          solve(weighted * c_.transpose(), weighted * e.middleRows<2>(2 * f).transpose()).transpose();
    }
    for (Eigen::Index p = 0; p < points; ++p) {
      const Eigen::VectorXd twice = weight_.col(p).matrix().transpose().replicate(2, 1).reshaped();
      const Eigen::MatrixXd weighted = a_.transpose() * twice.asDiagonal();
      c_.col(p) = solve(weighted * a_, weighted * e.col(p));
    }
  }
}

Eigen::Vector2d RobustTracks::remainder(Eigen::Index f, Eigen::Index p) const {
  if (a_.cols() == 0) return Eigen::Vector2d::Zero();
  return a_.middleRows<2>(2 * f) * c_.col(p);
}

Eigen::Vector3d RobustTracks::place(Eigen::Index f, Eigen::Index p) const {
  const Eigen::Map<const Eigen::Matrix3Xd> b(shapes_.col(p).data(), 3, model_.terms());
  return std::exp(model_.log_scale(f)) *
         (model_.rotation[static_cast<std::size_t>(f)] * (b * weights_over_time_.row(f).transpose()));
}

double RobustTracks::nearness(Eigen::Index f, Eigen::Index p) const {
  return std::max(nearest, 1 + kappa_ * place(f, p).z());
}

Eigen::Vector2d RobustTracks::track(Eigen::Index f, Eigen::Index p) const {
  return model_.centre + (tracks_.block<2, 1>(2 * f, p) - model_.centre) * nearness(f, p) - remainder(f, p);
}

void RobustTracks::fit_perspective() {
  double normal = 0, right = 0, radius = 0;
  for (Eigen::Index f = 0; f < seen_.rows(); ++f)
    for (Eigen::Index p = 0; p < seen_.cols(); ++p) {
      if (!(weight_(f, p) > 0)) continue;
      const Eigen::Vector3d q = place(f, p);
      const Eigen::Vector2d slope = (tracks_.block<2, 1>(2 * f, p) - model_.centre) * q.z();
      normal += weight_(f, p) * slope.squaredNorm();
      right -= weight_(f, p) * slope.dot(residual(f, p));
      radius = std::max(radius, q.norm());
    }
  const double most = radius > 0 ? most_perspective / radius : 0;
  if (normal > 0) kappa_ = std::clamp(kappa_ + right / normal, -most, most);
}

Eigen::Matrix<double, 2, Eigen::Dynamic> RobustTracks::rows(Eigen::Index f) const {
  const Eigen::Matrix<double, 2, 3> camera =
      std::exp(model_.log_scale(f)) * model_.rotation[static_cast<std::size_t>(f)].topRows<2>();
  Eigen::Matrix<double, 2, Eigen::Dynamic> m(2, 3 * model_.terms());
  for (Eigen::Index k = 0; k < model_.terms(); ++k) m.middleCols<3>(3 * k) = weights_over_time_(f, k) * camera;
  return m;
}

Eigen::Vector2d RobustTracks::predicted(Eigen::Index f, const Eigen::VectorXd& shape) const {
  return rows(f) * shape + model_.translation.col(f);
}

Eigen::Vector2d RobustTracks::residual(Eigen::Index f, Eigen::Index p) const {
  return track(f, p) - predicted(f, shapes_.col(p));
}

Eigen::MatrixXd RobustTracks::completed() const {
  Eigen::MatrixXd all(tracks_.rows(), tracks_.cols());
  for (Eigen::Index f = 0; f < seen_.rows(); ++f)
    for (Eigen::Index p = 0; p < seen_.cols(); ++p) {
      const bool measured = seen_(f, p) && weight_(f, p) > 0;
      all.block<2, 1>(2 * f, p) = remainder(f, p) + (measured ? track(f, p) : predicted(f, shapes_.col(p)));
    }
  return all;
}

Eigen::VectorXd RobustTracks::shape(Eigen::Index p, const Eigen::ArrayXd& weights) const {
  const Eigen::Index n = shapes_.rows();
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (Eigen::Index f = 0; f < model_.frame_count(); ++f) {
    if (!(weights(f) > 0)) continue;
    const Eigen::Matrix<double, 2, Eigen::Dynamic> m = rows(f);
    normal.noalias() += weights(f) * m.transpose() * m;
    right.noalias() += weights(f) * m.transpose() * (track(f, p) - model_.translation.col(f));
  }
  normal.diagonal().array() += 1e-9 * normal.trace() / static_cast<double>(n);
  return linear::solve_ldlt(normal, right);
}

void RobustTracks::fit_points() {
  for (Eigen::Index p = 0; p < model_.point_count(); ++p) shapes_.col(p) = shape(p, weight_.col(p));
}

void RobustTracks::fit_frames() {
  for (Eigen::Index f = 0; f < model_.frame_count(); ++f) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    Eigen::Matrix3d& rotation = model_.rotation[static_cast<std::size_t>(f)];
    for (Eigen::Index p = 0; p < model_.point_count(); ++p) {
      if (!(weight_(f, p) > 0)) continue;
      const Eigen::Vector3d q = place(f, p);
      Eigen::Matrix<double, 2, 6> m;
      m << 0, q.z(), -q.y(), 1, 0, q.x(), -q.z(), 0, q.x(), 0, 1, q.y();
      normal.noalias() += weight_(f, p) * m.transpose() * m;
      right.noalias() += weight_(f, p) * m.transpose() * residual(f, p);
    }
    const double ridge = 1e-12 * normal.trace();
    normal.diagonal().array() += ridge + (ridge > 0 ? 0.0 : 1.0);
    const Eigen::Matrix<double, 6, 1> step = linear::solve_ldlt(normal, right);
    rotation = turned_by(step.head<3>()) * rotation;
    model_.translation.col(f) += step.segment<2>(3);
    model_.log_scale(f) += step(5);
  }
}

double RobustTracks::typical() const {
  std::vector<double> squares;
  for (Eigen::Index f = 0; f < seen_.rows(); ++f)
    for (Eigen::Index p = 0; p < seen_.cols(); ++p)
      if (seen_(f, p)) squares.push_back(residual(f, p).squaredNorm());
  const double largest = tracks_.array().isFinite().select(tracks_.array(), 0.0).abs().maxCoeff();
  return std::max(std::sqrt(stats::median(squares) / (2 * std::numbers::ln2)), 1e-12 * largest);
}

void RobustTracks::reweigh(bool least_distances) {
  const double unit = typical();
  for (Eigen::Index f = 0; f < seen_.rows(); ++f)
    for (Eigen::Index p = 0; p < seen_.cols(); ++p) {
      if (!seen_(f, p)) continue;
      const double d = residual(f, p).norm() / unit, t = d / biweight_reach;
      weight_(f, p) = least_distances ? 1 / std::max(d, least_distance) : t < 1 ? (1 - t * t) * (1 - t * t) : 0;
    }
}

// Of the point's numbers, its shape and its part of C, and approximately of the frame's, which many points share.
void RobustTracks::find_leverages() {
  const Eigen::Index n = shapes_.rows(), q = a_.cols();
  const auto design = [&](Eigen::Index f) {
    Eigen::Matrix<double, 2, Eigen::Dynamic> m(2, n + q);
    m << rows(f), a_.middleRows<2>(2 * f);
    return m;
  };
  for (Eigen::Index p = 0; p < seen_.cols(); ++p) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n + q, n + q);
    for (Eigen::Index f = 0; f < seen_.rows(); ++f)
      if (weight_(f, p) > 0) normal.noalias() += weight_(f, p) * design(f).transpose() * design(f);
    const Eigen::VectorXd scale = normal.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
    normal = (scale.asDiagonal() * normal * scale.asDiagonal()).eval();
    normal.diagonal().array() += 1e-9;
    const linear::Ldlt factor(normal);
    for (Eigen::Index f = 0; f < seen_.rows(); ++f) {
      if (!seen_(f, p)) continue;
      const Eigen::MatrixXd m = scale.asDiagonal() * design(f).transpose();
      const double of_point = 0.5 * (m.transpose() * factor.solve(m)).trace();
      const double of_frame = (3.0 + static_cast<double>(q)) / std::max(3.0, weight_.row(f).sum());
      leverage_(f, p) = std::min(most_leverage, of_point + of_frame);
    }
  }
}

double noise_of(const Solved& solved, const RobustTracks& fit, double left_by_fit) {
  double sigma = std::min(left_by_fit, noise_of(interpolated(solved.sequence)));
  Eigen::MatrixXd w = fit.completed();
  const SolvedModel& m = fit.model();
  double used = 0;
  for (Eigen::Index f = 0; f < m.frame_count(); ++f)
    for (Eigen::Index p = 0; p < m.point_count(); ++p) used += fit.seen(f, p) && fit.weight(f, p) > 0 ? 2 : 0;
  w.colwise() -= w.rowwise().mean().eval();
  const Eigen::Index rank = std::min(3 * m.terms() + 9, std::min(w.rows(), w.cols()) / 2);
  const double left = double((w.rows() - rank) * (w.cols() - 1 - rank)) - (double(w.size()) - used);
  if (rank <= 3 * m.terms() || !(left > 0)) return sigma;
  const linear::DividedSvd svd(w);
  return std::min(sigma, std::sqrt(svd.singularValues().tail(svd.singularValues().size() - rank).squaredNorm() / left));
}

}  // namespace gonio::nrsfm
