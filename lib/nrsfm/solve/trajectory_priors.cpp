// Translations of frames that miss points, and priors for what frames and cameras leave open.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "nrsfm/solve/shape_trajectory.h"

namespace gonio::nrsfm {
namespace {

Eigen::MatrixXd predicted(const ShapeTrajectoryProblem& problem, const ShapeTrajectory& fit) {
  Eigen::MatrixXd tracks(problem.tracks.rows(), problem.tracks.cols());
  for (Eigen::Index f = 0; f < fit.coefficients.rows(); ++f) {
    Eigen::Matrix3Xd shape = Eigen::Matrix3Xd::Zero(3, tracks.cols());
    for (Eigen::Index k = 0; k < fit.coefficients.cols(); ++k) {
      shape += fit.coefficients(f, k) * fit.basis.middleRows<3>(3 * k);
    }
    tracks.middleRows<2>(2 * f) = problem.rows.middleRows<2>(2 * f) * shape;
  }
  return tracks;
}

// The translation takes the mean residual of each row; what that takes away from the sum of squares.
double follow_translation(ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& predicted,
                          Eigen::VectorXd& translation) {
  double moved = 0;
  for (Eigen::Index row = 0; row < problem.tracks.rows(); ++row) {
    const Eigen::ArrayXd visible = problem.visible.row(row / 2).cast<double>().transpose();
    const double count = std::max(visible.sum(), 1.0);
    const double shift = (visible * (problem.tracks.row(row) - predicted.row(row)).transpose().array()).sum() / count;
    translation(row) += shift;
    moved += shift * shift * count;
    problem.tracks.row(row) -= (visible * shift).matrix().transpose();
  }
  return moved;
}

// Mean squares of a residual, of a number, and how residuals of neighbouring frames agree.
struct Residual {
  double variance = 0;
  double rho = 0;  // correlation of frames that follow each other
};

Residual residual_of(const ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& predicted, Eigen::Index per_point) {
  double sum = 0, products = 0, neighbours = 0, left_free = 0;
  for (Eigen::Index p = 0; p < problem.visible.cols(); ++p) {
    const Eigen::VectorXd residual = problem.tracks.col(p) - predicted.col(p);
    for (Eigen::Index f = 0; f < problem.visible.rows(); ++f) {
      if (!problem.visible(f, p)) continue;
      const double square = residual.segment<2>(2 * f).squaredNorm();
      sum += square;
      if (f == 0 || !problem.visible(f - 1, p)) continue;
      products += residual.segment<2>(2 * f).dot(residual.segment<2>(2 * f - 2));
      neighbours += (square + residual.segment<2>(2 * f - 2).squaredNorm()) / 2;
    }
    left_free += static_cast<double>(std::max<Eigen::Index>(2 * problem.visible.col(p).count() - per_point, 0));
  }
  const double seen = 2 * static_cast<double>(problem.visible.count());
  return {sum / std::max(left_free, 0.1 * seen), neighbours > 0 ? std::clamp(products / neighbours, 0.0, 0.95) : 0};
}

// What the rigid model with the same cameras leaves and explains, per number; translation and tracks follow it.
struct RigidSizes {
  double deformation = 0, extent = 0;  // mean squares
};

RigidSizes fit_rigid(ShapeTrajectoryProblem& problem, Eigen::VectorXd& translation) {
  const Eigen::Index points = problem.tracks.cols();
  const double frames = static_cast<double>(problem.visible.rows()), energy = problem.tracks.squaredNorm();
  ShapeTrajectory rigid;
  rigid.coefficients = Eigen::MatrixXd::Ones(problem.visible.rows(), 1);
  rigid.basis.resize(3, points);
  RigidSizes sizes;
  double share = 1e-2;  // deformation over extent
  for (int round = 0; round < 200; ++round) {
    const double ridge = share / frames * problem.rows.squaredNorm() / 3;
    for (Eigen::Index p = 0; p < points; ++p) {
      Eigen::Matrix3d normal = ridge * Eigen::Matrix3d::Identity();
      for (Eigen::Index f = 0; f < problem.visible.rows(); ++f) {
        const auto rows = problem.rows.middleRows<2>(2 * f);
        if (problem.visible(f, p)) normal += rows.transpose() * rows;
      }
      rigid.basis.col(p) = linear::solve_ldlt(normal, problem.rows.transpose() * problem.tracks.col(p));
    }
    rigid.basis.colwise() -= rigid.basis.rowwise().mean().eval();
    const Eigen::MatrixXd seen = predicted(problem, rigid);
    const double moved = follow_translation(problem, seen, translation);
    sizes.deformation = residual_of(problem, seen, 3).variance;
    sizes.extent = (problem.rows * rigid.basis).squaredNorm() / static_cast<double>(seen.size());
    share = std::min(1.0, sizes.deformation / std::max(sizes.extent, 1e-300));
    if (moved <= 1e-10 * energy) break;
  }
  return sizes;
}

}  // namespace

ShapeTrajectory fit_with_translation(ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& start,
                                     Eigen::VectorXd& translation) {
  const double energy = problem.tracks.squaredNorm(), least = problem.ridge;
  const double frames = static_cast<double>(problem.visible.rows());
  const RigidSizes sizes = fit_rigid(problem, translation);
  const auto set_priors = [&](double variance) {
    const auto over = [&](double size) { return variance / (frames * std::max(size, 1e-300)); };
    problem.ridge = std::clamp(over(sizes.deformation), least, 1 / frames);
    problem.mean_ridge = std::clamp(over(sizes.extent), 1e-14, 1 / frames);
  };
  set_priors(1e-2 * sizes.deformation);
  problem.tolerance = 1e-5;  // of each round
  ShapeTrajectory fit = fit_shape_trajectory(problem, start);
  for (int round = 0; round < 10 && fit.coefficients.cols() > 0; ++round) {
    fit.basis.colwise() -= fit.basis.rowwise().mean().eval();
    const Eigen::MatrixXd seen = predicted(problem, fit);
    const double moved = follow_translation(problem, seen, translation), before = problem.ridge;
    const Residual left = residual_of(problem, seen, fit.basis.rows());
    set_priors(left.variance * (1 + left.rho) / (1 - left.rho));
    if (moved <= 1e-24 * energy && problem.ridge >= 0.5 * before) break;
    const ShapeTrajectory next = fit_shape_trajectory(problem, fit.x);
    const bool settled = std::abs(fit.cost - next.cost) <= 1e-3 * fit.cost;
    const int iterations = fit.iterations + next.iterations;
    fit = next;
    fit.iterations = iterations;
    if (settled) break;
  }
  fit.basis.colwise() -= fit.basis.rowwise().mean().eval();
  return fit;
}

}  // namespace gonio::nrsfm
