#include "mesh/register/adjustment.h"

#include <algorithm>
#include <cmath>

#include "linear/blocks.h"
#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "mesh/register/propagated.h"

namespace gonio::mesh {
namespace {

constexpr int most_iterations = 40;
constexpr double still = 0.03;         // standard deviations of the motions: a smaller step ends the search
constexpr int jumping = 8;             // steps after which they are halved
constexpr double usual_inflation = 4;  // of points that are as dense on both sides, compared both ways
constexpr double width = 3;            // of Huber's loss
constexpr double by_pose = 0.5;        // share of a direction's information from which on its prior holds it

ViewMotion motion_of(const Vector6& x, const MotionScale& scale) {
  const Vec3 turn{x[0] / scale.length_m, x[1] / scale.length_m, x[2] / scale.length_m}, shift{x[3], x[4], x[5]};
  const Quaternion q = quaternion_of_rotation_vector(turn);
  return {q, scale.centre_m + shift - matrix_of(q) * scale.centre_m};
}

Vector6 unknowns_of(const ViewMotion& motion, const MotionScale& scale) {
  Vector6 x;
  x << linear::as_eigen(rotation_vector_of(motion.rotation) * scale.length_m),
      linear::as_eigen(motion * scale.centre_m - scale.centre_m);
  return x;
}

// The centre is moved by a turn about the camera, too.
Matrix6 covariance_of(const PoseDoubt& doubt, const MotionScale& scale) {
  Matrix6 to = Matrix6::Identity();
  to.topLeftCorner<3, 3>() *= scale.length_m;
  to.bottomLeftCorner<3, 3>() = -linear::cross_matrix(linear::as_eigen(scale.centre_m - doubt.camera_m));
  return to * Eigen::Map<const Matrix6>(doubt.covariance.data()) * to.transpose();
}

// Precision of the motions against the fixed view, whose own doubt enters all of them.
Eigen::MatrixXd prior_of(const JointSystem& system, const std::vector<std::optional<PoseDoubt>>& doubts,
                         std::size_t fixed, const MotionScale& scale) {
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(system.unknowns(), system.unknowns());
  std::vector<std::size_t> stated;
  for (std::size_t v = 0; v < doubts.size(); ++v)
    if (doubts[v] && v != fixed) stated.push_back(v);
  if (stated.empty()) return precision;
  const auto size = 6 * static_cast<Eigen::Index>(stated.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index i = 0; i < size; i += 6) {
    covariance.block<6, 6>(i, i) = covariance_of(*doubts[stated[static_cast<std::size_t>(i / 6)]], scale);
    for (Eigen::Index j = 0; j < size && doubts[fixed]; j += 6)
      covariance.block<6, 6>(i, j) += covariance_of(*doubts[fixed], scale);
  }
  const Eigen::MatrixXd own = linear::inverse(covariance);
  for (Eigen::Index i = 0; i < size; i += 6)
    for (Eigen::Index j = 0; j < size; j += 6)
      precision.block<6, 6>(system.place[stated[static_cast<std::size_t>(i / 6)]],
                            system.place[stated[static_cast<std::size_t>(j / 6)]]) = own.block<6, 6>(i, j);
  return precision;
}

// Largest motion of one view's points along a unit direction of all views.
double largest_part(const Eigen::VectorXd& direction) {
  double most = 0;
  for (Eigen::Index k = 0; k < direction.size(); k += 6) most = std::max(most, direction.segment<6>(k).norm());
  return most;
}

struct Step {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance, open;
  double inflation = 1, sigmas = 0;  // rms of the step over its standard deviations
};

// As the patches show it, with what the best motion would take put back.
Eigen::MatrixXd seen_scatter(const std::vector<PairSums>& pairs, const JointSystem& system, const Filled& filled) {
  const Eigen::VectorXd alone =
      filled.directions * (filled.directions.transpose() * system.pull).cwiseQuotient(filled.values);
  return scatter_after(pairs, system, alone);
}

Step step_of(const JointSystem& system, const Filled& filled, const Eigen::MatrixXd& scatter,
             const Eigen::MatrixXd& prior, const Eigen::VectorXd& so_far, double limit_m) {
  Step step;
  step.inflation = inflation_of(filled, scatter);
  const Eigen::MatrixXd whole =
      filled.directions * filled.values.asDiagonal() * filled.directions.transpose() / step.inflation + prior;
  const Eigen::MatrixXd varies = scatter / (step.inflation * step.inflation) + prior;
  const linear::EigenPairs parts = linear::eigen_of(whole);
  const double least = 1e-12 * parts.largest();
  std::vector<Eigen::Index> held, open;
  for (Eigen::Index k = 0; k < parts.values.size(); ++k) {
    const Eigen::VectorXd v = parts.vectors.col(k);
    const double value = parts.values[k];
    const double sigma_m = value > least ? std::sqrt(v.dot(varies * v)) / value * largest_part(v) : 1e300;
    (value > least && (sigma_m <= limit_m || v.dot(prior * v) >= by_pose * value) ? held : open).push_back(k);
  }
  step.open.resize(system.unknowns(), static_cast<Eigen::Index>(open.size()));
  for (std::size_t k = 0; k < open.size(); ++k)
    step.open.col(static_cast<Eigen::Index>(k)) = parts.vectors.col(open[k]);
  Eigen::MatrixXd back = Eigen::MatrixXd::Zero(system.unknowns(), system.unknowns());
  for (const Eigen::Index k : held) back += parts.vectors.col(k) * parts.vectors.col(k).transpose() / parts.values[k];
  step.x = back * (system.pull / step.inflation - prior * so_far);
  step.covariance = back * varies * back;
  for (const Eigen::Index k : held) {
    const double along = parts.vectors.col(k).dot(step.x);
    step.sigmas += along * along / parts.vectors.col(k).dot(step.covariance * parts.vectors.col(k)) /
                   static_cast<double>(held.size());
  }
  step.sigmas = std::sqrt(step.sigmas);
  return step;
}

}  // namespace

std::vector<ViewOverlap> all_overlaps(const std::vector<ViewSurface>& surfaces, const std::vector<ViewMotion>& motions,
                                      double reach_m) {
  std::vector<ViewOverlap> all;
  for (std::size_t a = 0; a < surfaces.size(); ++a)
    for (std::size_t b = 0; b < surfaces.size(); ++b)
      if (a != b) all.push_back(overlap_of(surfaces, motions, a, b, reach_m));
  return all;
}

namespace {

// Mean square of the residuals as they count, over what is predicted.
double counted_square(const std::vector<ViewOverlap>& overlaps) {
  double sum = 0, count = 0;
  for (const ViewOverlap& o : overlaps)
    for (const OverlapPoint& p : o.points) {
      const double z = p.weight * p.residual.off_m / p.residual.sigma_m;
      sum += z * z, ++count;
    }
  return count > 0 ? sum / count : 1;
}

// What the points' covariances say, as much more as residuals are larger than predicted, and as patches show.
Eigen::MatrixXd final_scatter(const std::vector<ViewSurface>& surfaces, const Adjustment& made, const Filled& filled,
                              const Eigen::MatrixXd& seen) {
  const Eigen::MatrixXd stated = std::max(1.0, counted_square(made.overlaps)) *
                                 propagated_scatter(surfaces, made.motions, made.overlaps, made.scale, made.system);
  return stated * std::max(1.0, inflation_of(filled, seen) / inflation_of(filled, stated));
}

}  // namespace

Adjustment adjust(const std::vector<ViewSurface>& surfaces, std::vector<ViewOverlap> overlaps,
                  const std::vector<std::optional<PoseDoubt>>& doubts, const RegisterWish& wish, double reach_m) {
  Adjustment made;
  made.motions.resize(surfaces.size());
  made.overlaps = std::move(overlaps);
  made.scale = scale_of(made.overlaps, surfaces);
  for (bool fine = false; made.iterations < most_iterations; ++made.iterations) {
    if (made.iterations > 0) made.overlaps = all_overlaps(surfaces, made.motions, reach_m);
    weigh(made.overlaps, width);
    const std::vector<PairSums> pairs = sums_of(made.overlaps, made.scale);
    made.system = joint_of(pairs, surfaces.size(), wish.fixed);
    const auto each_moved = [&](const auto& visit) {
      for (std::size_t v = 0; v < surfaces.size(); ++v)
        if (made.system.place[v] >= 0) visit(v, made.system.place[v]);
    };
    Eigen::VectorXd so_far = Eigen::VectorXd::Zero(made.system.unknowns());
    each_moved([&](std::size_t v, int at) { so_far.segment<6>(at) = unknowns_of(made.motions[v], made.scale); });
    const Eigen::MatrixXd prior = prior_of(made.system, doubts, wish.fixed, made.scale);
    const Filled filled = filled_directions(made.system);
    // As long as views lie apart, what they show is not noise.
    const Eigen::MatrixXd scatter =
        fine ? final_scatter(surfaces, made, filled, seen_scatter(pairs, made.system, filled))
             : Eigen::MatrixXd(usual_inflation * made.system.raw);
    Step step = step_of(made.system, filled, scatter, prior, so_far, wish.limit_m);
    made.covariance = step.covariance, made.open = step.open, made.inflation = step.inflation;
    // Pairs that come and go let steps jump to and fro.
    const bool jumps = made.iterations >= jumping;
    made.converged = fine && step.sigmas <= (jumps ? 3 : 1) * still;
    if (made.converged) break;
    fine = fine || step.sigmas <= still || made.iterations >= most_iterations / 2;
    if (jumps) step.x *= 0.5;
    each_moved([&](std::size_t v, int) {
      made.motions[v] = motion_of(made.system.motion_of(step.x, v), made.scale) * made.motions[v];
    });
  }
  return made;
}

}  // namespace gonio::mesh
